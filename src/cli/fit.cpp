#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <utility>

#include <darboux/fit_points.h>
#include <darboux/io.h>

#include "command.h"
#include "csv_text.h"

namespace darboux {
namespace {

struct Arguments {
  std::string file, surface = "auto", noise, frames;
  bool with_uv = false;
  std::uint64_t seed = PointFitOptions{}.seed;
};

// What --surface permits: with uvs any kind, else those that can be found.
std::vector<std::string> permitted_kinds(bool with_uv) {
  std::vector<std::string> kinds{"auto"};
  if (with_uv)
    for (const AnySurface& surface : all_surfaces()) kinds.emplace_back(surface.info().name);
  else
    kinds.insert(kinds.end(), found_kinds().begin(), found_kinds().end());
  return kinds;
}

PointFitOptions parse_options(const Arguments& arguments) {
  const std::vector<std::string> kinds = permitted_kinds(arguments.with_uv);
  if (arguments.surface.find(':') != std::string::npos)
    throw ParameterError("--surface",
                         "fit finds the parameters, name the kind only: permitted are " + join(kinds));
  if (std::find(kinds.begin(), kinds.end(), arguments.surface) == kinds.end())
    throw ParameterError("--surface", "'" + arguments.surface + "' is no kind that is found" +
                                          (arguments.with_uv ? "" : " without uvs") + ", permitted are " +
                                          join(kinds));
  PointFitOptions options;
  options.surface = arguments.surface;
  options.with_uv = arguments.with_uv;
  options.seed = arguments.seed;
  if (!arguments.noise.empty()) {
    options.noise = parse_finite("--noise", arguments.noise);
    if (!(*options.noise > 0))
      throw ParameterError("--noise", arguments.noise + " is out of range, permitted is 0 < SIGMA");
  }
  return options;
}

// Over the inliers.
struct FrameSpread {
  Spread normal, tangent;
};

constexpr std::string_view frames_header =
    "index,u,v,position_x,position_y,position_z,tangent_x,tangent_y,tangent_z,bitangent_x,bitangent_y,"
    "bitangent_z,normal_x,normal_y,normal_z,normal_deg,tangent_deg,inlier,distance,status\n";

// One row of --frames. The distance is that of the point from the surface, positive where n points.
void append_row(std::string& text, std::size_t index, const UncertainFrame& f, bool inlier, double distance) {
  text += std::to_string(index);
  for (const double x : {f.uv.x, f.uv.y, f.position.x, f.position.y, f.position.z, f.t.x, f.t.y, f.t.z, f.b.x,
                         f.b.y, f.b.z, f.n.x, f.n.y, f.n.z, f.normal_deg, f.tangent_deg}) {
    text += ',';
    append_shortest(text, x);
  }
  text += inlier ? ",1," : ",0,";
  append_shortest(text, distance);
  text += ',';
  append_joined_status(text, f.status);
  text += '\n';
}

UncertainFrame no_frame_at_all() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  UncertainFrame f{};
  f.uv = {nan, nan};
  f.position = f.t = f.b = f.n = {nan, nan, nan};
  f.normal_deg = f.tangent_deg = nan;
  f.status = Status::non_finite_input;
  return f;
}

// The frame at every point, to the file where there is one, and summed up over the inliers.
FrameSpread frames_of(const PointCloud& cloud, const PointFit& fit, OutputFile* file,
                      const std::function<void(double)>& progress) {
  FrameSpread spread;
  std::string row;
  if (file) file->write(frames_header);
  const std::size_t n = cloud.positions.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 4096 == 0) progress(static_cast<double>(i) / static_cast<double>(n));
    const bool inlier = fit.is_inlier[i];
    if (!inlier && !file) continue;
    const Vec3<double>& p = cloud.positions[i];
    const UncertainFrame f = detail::finite(p) ? frame_near(fit, p) : no_frame_at_all();
    if (inlier) {
      spread.normal.add(f.normal_deg);
      spread.tangent.add(f.tangent_deg);
    }
    if (!file) continue;
    row.clear();
    append_row(row, i, f, inlier, dot(p - f.position, f.n));
    file->write(row);
  }
  if (file) file->commit();
  return spread;
}

Json fit_json(const Arguments& arguments, const PointFit& fit, const std::optional<FrameSpread>& spread) {
  Json json{{"file", arguments.file}, {"surface", nullptr}};
  if (fit.usable) {
    Json placement = Json::array();
    for (Eigen::Index k = 0; k < 16; ++k)
      placement.push_back(number(fit.surface->placement.matrix()(k % 4, k / 4)));
    json["surface"] = surface_json(fit.surface->surface);
    json["surface"]["placement"] = placement;
  }
  json["usable"] = fit.usable;
  json["reason"] = fit.reason;
  json["sigma"] = number(fit.sigma);
  json["rms"] = number(fit.rms);
  json["inliers"] = fit.inliers;
  json["outliers"] = fit.outliers;
  json["ignored"] = fit.ignored;
  json["mirrored"] = fit.mirrored;
  json["standard_errors"] = Json::object();
  for (const StandardError& e : fit.standard_errors) json["standard_errors"][e.name] = number(e.value);
  json["frame_uncertainty_deg"] = nullptr;
  if (spread)
    json["frame_uncertainty_deg"] = {{"normal", spread_json(spread->normal)},
                                     {"tangent", spread_json(spread->tangent)}};
  json["candidates"] = Json::array();
  for (const FitCandidate& c : fit.candidates)
    json["candidates"].push_back({{"name", c.name}, {"bic", number(c.bic)}, {"rms", number(c.rms)}});
  json["seed"] = arguments.seed;
  json["iterations"] = fit.iterations;
  json["seconds"] = number(fit.seconds);
  return json;
}

// "    label          text"
void print_line(std::string label, const std::string& text) {
  label.resize(std::max<std::size_t>(label.size() + 1, 16), ' ');
  std::cout << "  " << label << text << '\n';
}

std::string vector_text(const Eigen::Vector3d& a) {
  return "(" + rounded(a.x(), 6) + ", " + rounded(a.y(), 6) + ", " + rounded(a.z(), 6) + ")";
}

std::string spread_text(const Spread& s) {
  std::string text;
  if (s.finite() > 0) text = "uncertain by " + rounded(s.rms(), 3) + " deg rms";
  if (s.infinite() > 0)
    return text + (text.empty() ? "" : "; ") + "unknown at " + std::to_string(s.infinite()) +
           " points, a pole is too near";
  return text + ", at most " + rounded(s.max(), 3);
}

void print_people(const Arguments& arguments, const PointFit& fit, const std::optional<FrameSpread>& spread) {
  const auto plus_minus = [&](const std::string& name, const std::string& unit = "") {
    for (const StandardError& e : fit.standard_errors)
      if (e.name == name) return " ± " + rounded(e.value, 2) + unit;
    return std::string();
  };
  std::cout << one_line(arguments.file) << ": "
            << (fit.usable ? std::string(fit.surface->surface.info().name) : "not usable") << '\n';
  print_line("reason", one_line(fit.reason));
  print_line("points", std::to_string(fit.inliers) + " on the surface, " + std::to_string(fit.outliers) +
                           " outliers" +
                           (fit.ignored > 0 ? ", " + std::to_string(fit.ignored) + " not finite" : ""));
  if (fit.usable) {
    for (const ParameterValue& p : fit.surface->surface.parameters()) {
      const std::string name(p.name), error = plus_minus(name);
      print_line(name, rounded(p.value, 6) + (error.empty() ? ", encloses the points" : error));
    }
    const Eigen::Isometry3d& placement = fit.surface->placement;
    print_line("centre", vector_text(placement.translation()) + plus_minus("centre"));
    print_line("axis", vector_text(placement.linear().col(2)) + plus_minus("axis_deg", " deg"));
    print_line("noise",
               rounded(fit.sigma, 3) + " in each coordinate; distances " + rounded(fit.rms, 3) + " rms");
    print_line("normals", spread_text(spread->normal));
    print_line("tangents", spread_text(spread->tangent));
  }
  for (const FitCandidate& c : fit.candidates)
    print_line(&c == &fit.candidates.front() ? "tried" : "",
               c.name + std::string(c.name.size() < 12 ? 12 - c.name.size() : 1, ' ') + "bic " +
                   rounded(c.bic, 6) + ", rms " + rounded(c.rms, 3));
}

void run(const Arguments& arguments, Common& common) {
  PointFitOptions options = parse_options(arguments);
  if (arguments.frames == "-")
    throw ParameterError("--frames", "standard output has the report, permitted is the name of a file");
  std::optional<OutputFile> frames;
  if (!arguments.frames.empty()) frames.emplace(arguments.frames);

  PointFile points;
  PointFit fit;
  std::optional<FrameSpread> spread;
  {
    Progress progress("fit", common);
    const auto part = [&progress](double from, double to) {
      return [&progress, from, to](double share) { progress.update(from + (to - from) * share); };
    };
    points = read_points(arguments.file, part(0, 0.2));
    if (options.with_uv && points.cloud.uvs.empty())
      throw FileError(arguments.file, "holds no uvs, permitted with --with-uv are points with u and v");
    options.progress = part(0.2, 0.9);
    fit = fit_points(points.cloud, options);
    if (fit.usable) spread = frames_of(points.cloud, fit, frames ? &*frames : nullptr, part(0.9, 1));
  }

  const auto note = [&](const std::string& text) {
    if (!common.quiet) print_error(arguments.file + ": " + text);
  };
  if (fit.ignored > 0)
    note(std::to_string(fit.ignored) + (fit.ignored == 1 ? " point is" : " points are") +
         " not finite, ignored" +
         (points.first_not_finite.empty() ? "" : "; the first at " + points.first_not_finite));
  if (!fit.usable) {
    common.exit_status = 1;
    if (frames) note("there are no frames, " + arguments.frames + " is not written");
  }
  if (common.json)
    print_json(fit_json(arguments, fit, spread));
  else
    print_people(arguments, fit, spread);
}

}  // namespace

void add_fit(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("fit", "Find the surface that sampled points lie on, and frames at the points");
  auto arguments = std::make_shared<Arguments>();
  sub.add_option("FILE", arguments->file,
                 "points: .xyz, .txt, .csv, .tsv, .ply, .pcd, .obj, .stl, .glb or .gltf")
      ->required();
  sub.add_option("--surface", arguments->surface, "the kind, or auto: the one that explains the points best")
      ->capture_default_str();
  sub.add_option(
      "--noise", arguments->noise,
      "standard deviation of each coordinate where it is known, in the units of the points; else it is "
      "estimated");
  sub.add_flag("--with-uv", arguments->with_uv, "the file's uvs say where on the surface each point belongs");
  sub.add_option("--seed", arguments->seed, "of the random samples: same seed, same result")
      ->capture_default_str()
      ->check(whole_number);
  sub.add_option("--frames", arguments->frames,
                 "CSV file to write: the frame at each point and its uncertainty");
  add_common(sub, common, "darboux fit points.xyz --frames frames.csv");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
