#include "map_checks.h"

#include <iomanip>
#include <iostream>

#include <darboux/check_normal_map.h>

namespace darboux {
namespace {

constexpr const char* channel_names[] = {"red", "green", "blue"};

struct MapFinding {
  const char* code;
  std::string text;
};

std::vector<MapFinding> findings_of(const NormalMapCheck& check, const std::string& tag, MapGreen expected) {
  std::vector<MapFinding> result;
  const auto add = [&](bool found, const char* code, const std::string& text) {
    if (found) result.push_back({code, text});
  };
  add(!tag.empty(), "COLOUR_TAG", "the file says that its numbers are not linear (" + tag + ")");
  add(check.not_finite != 0, "NOT_FINITE", std::to_string(check.not_finite) + " texels are no direction");
  add(check.not_unit != 0, "NOT_UNIT",
      std::to_string(check.not_unit) + " texels have a length off 1 by more than rounding, from " +
          rounded(check.least_length, 3) + " to " + rounded(check.greatest_length, 3));
  add(check.below_surface != 0, "BELOW_SURFACE",
      std::to_string(check.below_surface) + " texels have z <= 0; a map in object space has many");
  add(check.z_channel.value_or(2) != 2, "Z_CHANNEL",
      std::string("z seems to be in ") + channel_names[check.z_channel.value_or(2)] + ", expected in blue");
  add(check.swapped.value_or(false), "SWAPPED", "red and green seem to be swapped");
  add(check.green.value_or(expected) != expected, "GREEN",
      std::string("green points ") +
          (expected == MapGreen::opengl ? "down, expected up" : "up, expected down") + ": " +
          std::to_string(check.voting_cells) + " cells tell, " + rounded(100 * check.agreeing, 3) +
          " % alike (an inverted red channel would look the same)");
  return result;
}

const char* green_name(const NormalMapCheck& check) {
  return check.green ? map_greens.names[static_cast<std::size_t>(*check.green)] : "undecided";
}

}  // namespace

void run_map_check(const MapCheckArguments& a, Common& common) {
  const MapSource source = map_source(a.file, &a.primitives, common);
  const std::string tag = image_colour_tag(source.name, source.bytes);
  const Image map = read_map(source, true, a.signed_floats, common);
  const NormalMapCheck check = check_normal_map(map, a.signed_floats);
  const std::vector<MapFinding> findings = findings_of(check, tag, map_greens.of(a.green));
  if (!findings.empty()) common.exit_status = 1;
  if (common.json) {
    Json list = Json::array();
    for (const MapFinding& f : findings) list.push_back({{"code", f.code}, {"text", f.text}});
    return print_json(
        {{"file", utf8(a.file)},
         {"width", map.width},
         {"height", map.height},
         {"depth", map_depths.names[static_cast<std::size_t>(map.type())]},
         {"colour_tag", tag.empty() ? Json() : Json(tag)},
         {"texels", check.texels},
         {"not_finite", check.not_finite},
         {"not_unit", check.not_unit},
         {"length", {{"min", number(check.least_length)}, {"max", number(check.greatest_length)}}},
         {"below_surface", check.below_surface},
         {"mean", {number(check.mean[0]), number(check.mean[1]), number(check.mean[2])}},
         {"flat", check.flat},
         {"z_channel", check.z_channel ? channel_names[*check.z_channel] : "undecided"},
         {"swapped", check.swapped ? Json(*check.swapped) : Json()},
         {"green", green_name(check)},
         {"voting_cells", check.voting_cells},
         {"agreeing", number(check.agreeing)},
         {"findings", list},
         {"ok", findings.empty()}});
  }
  if (common.quiet) {
    std::vector<std::string> codes;
    for (const MapFinding& f : findings) codes.emplace_back(f.code);
    std::cout << one_line(a.file) << ": " << (codes.empty() ? "nothing wrong" : joined(codes)) << '\n';
    return;
  }
  std::cout << one_line(a.file) << ": " << map.width << " x " << map.height << ", "
            << map_depths.names[static_cast<std::size_t>(map.type())]
            << (map.type() == SampleType::f32 ? "" : " bits") << '\n'
            << "green: " << green_name(check);
  if (check.green)
    std::cout << ", " << check.voting_cells << " cells tell, " << rounded(100 * check.agreeing, 3)
              << " % alike";
  std::cout << '\n';
  if (check.flat) std::cout << "flat: a material that reads it needs no tangents\n";
  for (const MapFinding& f : findings) std::cout << f.code << ": " << f.text << '\n';
  if (findings.empty()) std::cout << "nothing wrong\n";
}

void run_map_comparison(const MapCheckArguments& a, const MapArguments& mesh, bool drop_colour_tags,
                        Common& common) {
  for (const std::string& file : a.compared)
    check_map_files({{"--compare", file}, {"--mesh", mesh.mesh}}, "", a.report);
  std::optional<OutputFile> report;
  if (!a.report.empty()) report.emplace(a.report);
  std::vector<MapPiece> pieces;
  if (!mesh.mesh.empty()) pieces = map_pieces(mesh, common, false);
  const auto read = [&](const std::string& file) {
    const MapSource source = map_source(file, nullptr, common);
    check_files_apart({{"the image of --compare", source.file}}, {{"--report", a.report}});
    return read_map(source, drop_colour_tags, a.signed_floats, common);
  };
  const Image one = read(a.compared[0]), other = read(a.compared[1]);
  CompareMapsOptions options{.signed_floats = a.signed_floats};
  options.green_a = options.green_b = map_greens.of(a.green);
  options.worst = static_cast<int>(a.worst);
  const MapDifference d =
      naming_the_mesh(mesh.mesh, [&] { return compare_normal_maps(one, other, pieces, options); });
  if (report) write_image(*report, a.report, heat_map(d, one.width, one.height, d.angle_deg.max));
  const bool same = d.compared != 0 && d.not_finite == 0 && d.angle_deg.max <= a.max_angle_deg;
  if (!same) common.exit_status = 1;
  const auto mesh_of = [&](std::size_t piece) {
    return pieces.empty() ? Json() : Json(pieces[piece].mesh_index);
  };
  const auto primitive_of = [&](std::size_t piece) {
    return pieces.empty() ? Json() : Json(pieces[piece].primitive);
  };
  if (common.json) {
    Json islands = Json::array(), worst = Json::array();
    for (const MapDifference::Island& i : d.islands)
      islands.push_back({{"mesh", mesh_of(i.piece)},
                         {"primitive", primitive_of(i.piece)},
                         {"island", i.island},
                         {"texels", i.texels},
                         {"angle_deg", statistics_json(i.angle_deg)}});
    for (const MapDifference::Texel& t : d.worst)
      worst.push_back({{"texel", {t.x, t.y}}, {"angle_deg", number(t.angle_deg)}});
    return print_json({{"files", {utf8(a.compared[0]), utf8(a.compared[1])}},
                       {"compared", d.compared},
                       {"not_finite", d.not_finite},
                       {"angle_deg", statistics_json(d.angle_deg)},
                       {"islands", islands},
                       {"worst", worst},
                       {"same", same}});
  }
  if (common.quiet) {
    std::cout << (same ? "same" : "not the same") << '\n';
    return;
  }
  std::cout << d.compared << " texels compared";
  if (d.not_finite != 0) std::cout << ", " << d.not_finite << " are no direction in one of the maps";
  std::cout << "\ndegrees between them      texels      max      rms      p95\n";
  const auto row = [](const std::string& name, std::size_t texels, const Statistics& s) {
    std::cout << "  " << std::left << std::setw(20) << name << std::right << std::setw(10) << texels;
    for (const double x : {s.max, s.rms, s.p95}) std::cout << std::setw(9) << rounded(x, 3);
    std::cout << '\n';
  };
  constexpr std::size_t most_rows = 20;
  std::size_t rows = 0;
  for (const MapDifference::Island& i : d.islands)
    if (!pieces.empty() && rows++ < most_rows)
      row("mesh " + std::to_string(pieces[i.piece].mesh_index) + " island " + std::to_string(i.island),
          i.texels, i.angle_deg);
  if (rows > most_rows) std::cout << "  and " << rows - most_rows << " islands more, with --json\n";
  row("all", d.compared, d.angle_deg);
  if (!d.worst.empty())
    std::cout << "worst texel: (" << d.worst[0].x << ", " << d.worst[0].y << "), "
              << rounded(d.worst[0].angle_deg, 3) << " degrees\n";
  const std::string limit = "--max-angle " + rounded(a.max_angle_deg, 3);
  if (same)
    std::cout << "same: all within " << limit << '\n';
  else if (d.compared == 0)
    std::cout << "not the same: nothing was compared\n";
  else
    std::cout << "not the same: "
              << (d.angle_deg.max > a.max_angle_deg ? "over " + limit
                                                    : "some are no direction in one of the maps")
              << '\n';
}

}  // namespace darboux
