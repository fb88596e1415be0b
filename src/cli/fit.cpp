#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <darboux/fit_mesh.h>
#include <darboux/fit_points.h>
#include <darboux/io.h>

#include "base/counted.h"
#include "base/nearest_name.h"
#include "base/parallel_jobs.h"
#include "base/text.h"
#include "command.h"
#include "csv_text.h"

namespace darboux {
namespace {

struct FitArguments {
  std::string file, surface = "auto", noise, frames;
  bool with_uv = false;
  std::uint64_t seed = PointFitOptions{}.seed;
};

// The kinds that --surface accepts. Without uvs: those that fit_points() does not reject when it is called
// without points.
std::vector<std::string> kinds_to_fit(bool with_uv) {
  std::vector<std::string> kinds{"auto"};
  if (with_uv) kinds.insert(kinds.end(), fitted_kinds().begin(), fitted_kinds().end());
  for (const AnySurface& surface : all_surfaces()) {
    if (with_uv) break;
    PointFitOptions options;
    options.surface = surface.info().name;
    try {
      fit_points({}, options);
      kinds.push_back(options.surface);
    } catch (const ParameterError&) {
    }
  }
  return kinds;
}

PointFitOptions parse_options(const FitArguments& arguments) {
  const std::vector<std::string> kinds = kinds_to_fit(arguments.with_uv);
  if (arguments.surface.find(':') != std::string::npos)
    throw ParameterError("--surface",
                         expected_got("a kind without parameters, which fit finds: one of " + joined(kinds),
                                      "'" + arguments.surface + "'"));
  if (std::find(kinds.begin(), kinds.end(), arguments.surface) == kinds.end())
    throw ParameterError(
        "--surface",
        expected_got(std::string("a kind that is fitted ") + (arguments.with_uv ? "with" : "without") +
                         " uvs: one of " + joined(kinds),
                     "'" + arguments.surface + "'" + did_you_mean(arguments.surface, kinds)));
  PointFitOptions options;
  options.surface = arguments.surface;
  options.with_uv = arguments.with_uv;
  options.seed = arguments.seed;
  if (!arguments.noise.empty()) {
    options.noise = parse_finite("--noise", arguments.noise);
    if (!(*options.noise > 0)) throw ParameterError("--noise", expected_got("0 < SIGMA", arguments.noise));
  }
  return options;
}

// Which points of the file lie on the surface, and how many do not. In a mesh every vertex counts, and
// vertices at the same position get the same answer.
struct Membership {
  std::vector<bool> is_inlier;
  std::size_t inliers = 0, outliers = 0, not_finite = 0, unused = 0;
};

Membership membership(const PointFile& points, const PointFit& fit, bool with_uv) {
  const PointCloud& cloud = points.cloud;
  Membership result;
  std::size_t fitted = 0;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const std::size_t place = points.place.empty() ? i : points.place[i];
    const bool used = place != PointFile::unused;
    const bool inlier = used && (place == i ? fit.is_inlier[fitted++] : result.is_inlier[place]);
    const bool finite = detail::finite(cloud.positions[i]) && (!with_uv || detail::finite(cloud.uvs[i]));
    result.is_inlier.push_back(inlier);
    ++(!used ? result.unused : !finite ? result.not_finite : inlier ? result.inliers : result.outliers);
  }
  return result;
}

// Standard deviations, and the largest of those that are finite.
struct Deviations : Spread {
  double largest = 0;
  void add(double deviation) {
    Spread::add(deviation);
    if (std::isfinite(deviation)) largest = std::fmax(largest, deviation);
  }
};

// Over the inliers.
struct FrameSpread {
  Deviations normal, tangent;
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

// The frame at the point's own uv, if used, else at the nearest point. They differ where a surface intersects
// itself.
UncertainFrame frame_of(const PointCloud& cloud, std::size_t i, const PointFit& fit, bool with_uv) {
  const Vec3<double>& p = cloud.positions[i];
  if (!detail::finite(p) || (with_uv && !detail::finite(cloud.uvs[i]))) return no_frame_at_all();
  return with_uv ? frame_at(fit, fit.surface->uv.surface_uv(cloud.uvs[i])) : frame_near(fit, p);
}

// Computes the frame at every point, writes it to the file if there is one, and summarises over the inliers.
FrameSpread frames_of(const PointCloud& cloud, const PointFit& fit, const std::vector<bool>& is_inlier,
                      bool with_uv, OutputFile* file, int threads,
                      const std::function<void(double)>& progress) {
  constexpr std::size_t block = 16384, piece = 256;
  FrameSpread spread;
  std::string row;
  if (file) file->write(frames_header);
  const std::size_t n = cloud.positions.size();
  std::vector<UncertainFrame> frames(std::min(n, block));
  for (std::size_t begin = 0; begin < n; begin += block) {
    progress(static_cast<double>(begin) / static_cast<double>(n));
    const std::size_t end = std::min(n, begin + block);
    parallel_for((end - begin + piece - 1) / piece, threads,
                 [&](std::size_t k) {
                   const std::size_t from = begin + k * piece;
                   for (std::size_t i = from; i < std::min(end, from + piece); ++i)
                     if (is_inlier[i] || file) frames[i - begin] = frame_of(cloud, i, fit, with_uv);
                 },
                 [](double) {});
    for (std::size_t i = begin; i < end; ++i) {
      const UncertainFrame& f = frames[i - begin];
      if (is_inlier[i]) {
        spread.normal.add(f.normal_deg);
        spread.tangent.add(f.tangent_deg);
      }
      if (!file) continue;
      row.clear();
      append_row(row, i, f, is_inlier[i], dot(cloud.positions[i] - f.position, f.n));
      file->write(row);
    }
  }
  if (file) file->commit();
  return spread;
}

Json fit_json(const FitArguments& arguments, const PointFit& fit, const Membership& members,
              const std::optional<FrameSpread>& spread) {
  const bool fitted = fit.inliers > 0;
  Json json{{"file", arguments.file}, {"surface", nullptr}};
  if (fit.usable) {
    json["surface"] = surface_json(fit.surface->surface);
    json["surface"]["placement"] = numbers({fit.surface->placement.data(), 16});
  }
  json["usable"] = fit.usable;
  json["reason"] = fit.reason;
  json["sigma"] = fitted ? number(fit.sigma) : nullptr;
  json["rms"] = fitted ? number(fit.rms) : nullptr;
  json["inliers"] = members.inliers;
  json["outliers"] = members.outliers;
  json["ignored"] = members.not_finite + members.unused;
  json["mirrored"] = fit.mirrored;
  json["standard_errors"] = Json::object();
  for (const StandardError& e : fit.standard_errors) json["standard_errors"][e.name] = number(e.value);
  json["intervals"] = Json::object();
  for (const ConfidenceInterval& i : fit.intervals)
    json["intervals"][i.name] = Json::array({number(i.low), number(i.high)});
  json["interval_method"] = fit.interval_method.empty() ? Json(nullptr) : Json(fit.interval_method);
  json["level"] = fit.level;
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

// "  label           text"
void print_line(std::string label, const std::string& text) {
  label.resize(std::max<std::size_t>(label.size() + 1, 16), ' ');
  std::cout << "  " << label << text << '\n';
}

// At least six digits, and as many as its standard error has.
std::string known_text(double x, double error) {
  int digits = 6;
  if (error > 0 && std::fabs(x) > error)
    digits = std::clamp(
        2 + static_cast<int>(std::floor(std::log10(std::fabs(x))) - std::floor(std::log10(error))), 6, 15);
  return rounded(x, digits);
}

std::string vector_text(const Eigen::Vector3d& a, double error) {
  return "(" + known_text(a.x(), error) + ", " + known_text(a.y(), error) + ", " + known_text(a.z(), error) +
         ")";
}

std::string spread_text(const Deviations& s, const char* why_unknown) {
  std::string text;
  if (s.finite() > 0)
    text = "uncertain by " + rounded(s.rms(), 3) + " deg rms, at most " + rounded(s.largest, 3);
  if (s.infinite() > 0)
    text +=
        (text.empty() ? "" : "; ") + ("unknown at " + counted(s.infinite(), "point") + ", ") + why_unknown;
  return text;
}

void print_text(const FitArguments& arguments, const PointFit& fit, const Membership& members,
                const std::optional<FrameSpread>& spread, bool quiet) {
  const auto error_of = [&](std::string_view name) -> std::optional<double> {
    for (const StandardError& e : fit.standard_errors)
      if (e.name == name) return e.value;
    return std::nullopt;
  };
  const auto plus_minus = [&](std::string_view name, const std::string& unit = "") {
    const auto error = error_of(name);
    return error ? " ± " + rounded(*error, 2) + unit : std::string();
  };
  std::cout << one_line(arguments.file) << ": "
            << (fit.usable ? std::string(fit.surface->surface.info().name) : "not usable") << '\n';
  if (quiet) return;
  print_line("reason", one_line(fit.reason));
  const auto also = [](std::size_t count, const char* what) {
    return count > 0 ? ", " + std::to_string(count) + what : std::string();
  };
  print_line("points", (fit.usable ? std::to_string(members.inliers) + " on the surface, " +
                                         counted(members.outliers, "outlier")
                                   : std::to_string(members.inliers + members.outliers)) +
                           also(members.not_finite, " not finite") + also(members.unused, " in no triangle"));
  if (fit.usable) {
    for (const ParameterValue& p : fit.surface->surface.parameters()) {
      const std::string name(p.name), error = plus_minus(name);
      print_line(name, known_text(p.value, error_of(name).value_or(0)) +
                           (error.empty() ? ", encloses the points" : error));
    }
    const Eigen::Isometry3d& placement = fit.surface->placement;
    print_line("centre",
               vector_text(placement.translation(), error_of("centre").value_or(0)) + plus_minus("centre"));
    print_line("axis", vector_text(placement.linear().col(2),
                                   error_of("axis_deg").value_or(0) * std::numbers::pi / 180) +
                           plus_minus("axis_deg", " deg"));
    print_line("noise",
               rounded(fit.sigma, 3) + " in each coordinate; distances " + rounded(fit.rms, 3) + " rms");
    print_line("normals", spread_text(spread->normal, "too near an apex or a centre of curvature"));
    print_line("tangents", spread_text(spread->tangent, "too near a pole or without a normal"));
  }
  for (const FitCandidate& c : fit.candidates)
    print_line(&c == &fit.candidates.front() ? "tried" : "",
               c.name + std::string(c.name.size() < 20 ? 20 - c.name.size() : 1, ' ') + "bic " +
                   rounded(c.bic, 6) + ", rms " + rounded(c.rms, 3));
}

void run_fit(const FitArguments& arguments, Common& common) {
  PointFitOptions options = parse_options(arguments);
  if (is_standard_output(arguments.frames))
    throw ParameterError("--frames",
                         expected_got("the name of a file", "-: standard output holds the report"));
  known_extension("--frames", arguments.frames, {".csv", ".txt"});
  std::optional<OutputFile> frames;
  if (!arguments.frames.empty()) frames.emplace(arguments.frames);

  PointFile points;
  PointFit fit;
  Membership members;
  std::optional<FrameSpread> spread;
  {
    Progress progress("fit", common);
    const auto part = [&progress](double from, double to) {
      return [&progress, from, to](double share) { progress.update(from + (to - from) * share); };
    };
    points = read_points(arguments.file, part(0, 0.2), common.read);
    if (options.with_uv && points.cloud.uvs.empty())
      throw FileError(arguments.file,
                      expected_got("points with u and v for --with-uv",
                                   "none with uvs" + (points.note.empty() ? "" : " (" + points.note + ")")));
    options.progress = part(0.2, 0.9);
    fit = points.place.empty() ? fit_points(points.cloud, options)
                               : fit_points(distinct_points(points), options);
    members = membership(points, fit, options.with_uv);
    if (fit.usable)
      spread = frames_of(points.cloud, fit, members.is_inlier, options.with_uv, frames ? &*frames : nullptr,
                         common.threads, part(0.9, 1));
  }

  const auto note = [&](const std::string& text) {
    if (!common.quiet) print_error(arguments.file + ": " + text);
  };
  if (!points.note.empty()) note(points.note);
  if (members.not_finite > 0)
    note(counted(members.not_finite, "point is", "points are") + " not finite, ignored" +
         (points.first_not_finite.empty() ? "" : "; the first at " + points.first_not_finite));
  if (!fit.usable) {
    common.exit_status = 1;
    if (frames) note("there are no frames, " + arguments.frames + " is not written");
  }
  if (common.json)
    print_json(fit_json(arguments, fit, members, spread));
  else
    print_text(arguments, fit, members, spread, common.quiet);
}

}  // namespace

void add_fit(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("fit", "Find the surface that sampled points lie on, and the frames at the points");
  auto arguments = std::make_shared<FitArguments>();
  sub.add_option("FILE", arguments->file,
                 "points: .xyz, .txt, .csv, .tsv, .asc, .pts, .ply, .pcd, .obj, .stl, .glb or .gltf")
      ->required();
  sub.add_option("--surface", arguments->surface,
                 "the kind of surface, or auto for the kind that explains the points best; an unknown name "
                 "lists the kinds that can be fitted")
      ->capture_default_str();
  sub.add_option("--noise", arguments->noise,
                 "standard deviation of each coordinate, in the units of the points, if it is known; "
                 "otherwise it is estimated");
  sub.add_flag("--with-uv", arguments->with_uv,
               "take the uvs of the file as the (u, v) of the points on the surface");
  sub.add_option("--seed", arguments->seed, "seed of the random samples: the same seed gives the same result")
      ->capture_default_str()
      ->check(whole_number);
  sub.add_option("--frames", arguments->frames,
                 "write the frame at each point and its uncertainty to this CSV file");
  add_read_options(sub, common);
  add_common(sub, common, "darboux fit points.xyz --frames frames.csv");
  sub.callback([arguments, &common] { run_fit(*arguments, common); });
}

}  // namespace darboux
