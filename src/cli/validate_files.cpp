#include "validate_files.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <new>
#include <numeric>

#include <fnmatch.h>

#include "validate/findings.h"

namespace darboux {
namespace {

namespace fs = std::filesystem;

bool is_mesh_file(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  const auto& known = asset_extensions();
  return std::find(known.begin(), known.end(), extension) != known.end();
}

// The mesh files in a folder and in its folders; of a folder that cannot be listed the error.
void list_folder(const fs::path& folder, const fs::path& root, const std::vector<std::string>& exclude,
                 std::vector<JudgedFile>& found) {
  const auto is_excluded = [&](const fs::path& path) {
    const std::string relative = path.lexically_relative(root).generic_string();
    return std::any_of(exclude.begin(), exclude.end(), [&](const std::string& glob) {
      return fnmatch(glob.c_str(), relative.c_str(), 0) == 0;
    });
  };
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    std::error_code unknown;
    if (i->is_directory(unknown) && !i->is_symlink(unknown))
      list_folder(i->path(), root, exclude, found);
    else if (is_mesh_file(i->path()) && i->is_regular_file(unknown) && !is_excluded(i->path()))
      found.push_back({.path = i->path().string()});
  }
  if (error)
    found.push_back({.path = folder.string(),
                     .error = folder.string() + ": cannot be listed (" + error.message() +
                              "), permitted are folders that can be read"});
}

void list_folder(const std::string& folder, const std::vector<std::string>& exclude,
                 std::vector<JudgedFile>& files) {
  std::vector<JudgedFile> found;
  list_folder(fs::path(folder), fs::path(folder), exclude, found);
  if (found.empty())
    found.push_back({.path = folder,
                     .error = folder + ": holds no mesh file, permitted are folders with " +
                              joined({asset_extensions().begin(), asset_extensions().end()})});
  std::sort(found.begin(), found.end(),
            [](const JudgedFile& a, const JudgedFile& b) { return a.path < b.path; });
  files.insert(files.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
}

// Node transforms change what a renderer shows, not what the mesh stores: they give rise to findings only.
void add_node_findings(const Primitive& primitive, MeshReport& report) {
  std::size_t mirrored = 0, sheared = 0;
  for (const Eigen::Matrix4d& world : primitive.instances) {
    const Eigen::Matrix3d m = world.topLeftCorner<3, 3>();
    const Eigen::Matrix3d gram = m.transpose() * m;
    const double scale = gram.trace() / 3;
    mirrored += m.determinant() < 0;
    sheared += (gram - scale * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-5 * scale;
  }
  add(report, finding(Code::node_mirrored, mirrored));
  add(report, finding(Code::node_scale_not_uniform, sheared));
}

void apply(const Policy& policy, MeshReport& report, std::map<std::string, std::size_t>& ignored) {
  std::erase_if(report.findings, [&](const Finding& f) {
    const bool drop = std::find(policy.ignore.begin(), policy.ignore.end(), f.code) != policy.ignore.end();
    if (drop) ignored[std::string(f.code)] += f.count;
    return drop;
  });
  bool any_error = false;
  for (Finding& f : report.findings) {
    if (const auto asked = policy.severity.find(f.code); asked != policy.severity.end())
      f.severity = asked->second;
    if (policy.strict && f.severity == Severity::warning) f.severity = Severity::error;
    any_error = any_error || f.severity == Severity::error;
  }
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  report.verdict = any_error ? Verdict::fail : report.without_errors;
  if (policy.strict && report.verdict == Verdict::undetermined) report.verdict = Verdict::fail;
}

}  // namespace

std::size_t JudgedPrimitive::count(std::string_view code) const {
  std::size_t sum = 0;
  for (const Assessment& j : assessments)
    for (const Finding& f : j.report.findings) sum += f.code == code ? f.count : 0;
  return sum;
}

std::size_t JudgedPrimitive::known_count(std::string_view code) const {
  const auto at = known.find(code);
  return at == known.end() ? 0 : at->second;
}

bool JudgedPrimitive::less_determined() const {
  return static_cast<std::size_t>(std::count_if(
             assessments.begin(), assessments.end(),
             [](const Assessment& j) { return j.report.verdict == Verdict::undetermined; })) > known_not_pass;
}

std::vector<JudgedFile> files_of(const std::vector<std::string>& arguments,
                                 const std::vector<std::string>& exclude) {
  std::vector<JudgedFile> files;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (fs::is_directory(argument, error))
      list_folder(argument, exclude, files);
    else
      files.push_back({.path = argument});
  }
  return files;
}

namespace {

// Whether two primitives have the same assessment.
bool same(const Primitive& a, const Primitive& b) {
  const Mesh &x = a.data, &y = b.data;
  const auto steps = [](const Mesh& m) {
    const HalfSteps& s = m.half_steps;
    return std::tuple(s.position, s.normal, s.uv, s.tangent);
  };
  return x.positions == y.positions && x.normals == y.normals && x.uvs == y.uvs && x.tangents == y.tangents &&
         x.triangles == y.triangles && steps(x) == steps(y) && a.other_uvs == b.other_uvs &&
         a.names_uv_set == b.names_uv_set && a.texture_transform == b.texture_transform;
}

// For each primitive the first that is the same.
std::vector<std::size_t> first_of(const std::vector<Primitive>& primitives) {
  std::vector<std::size_t> result(primitives.size());
  for (std::size_t i = 0; i < primitives.size(); ++i)
    for (result[i] = 0; result[i] < i; ++result[i])
      if (same(primitives[result[i]], primitives[i])) break;
  return result;
}

// \param begun when the file was, whose primitives share the budget
std::vector<Assessment> judge_primitive(const Primitive& primitive, const AssessOptions& options,
                                        std::chrono::steady_clock::time_point begun) {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
  AssessOptions with_uvs = options;
  if (options.budget) with_uvs.budget = std::fmax(*options.budget - spent.count(), 0);
  with_uvs.other_uvs = primitive.other_uvs;
  with_uvs.names_uv_set = primitive.names_uv_set;
  with_uvs.texture_transform = primitive.texture_transform;
  return assess_parts(primitive.data, with_uvs);
}

}  // namespace

void judge_file(JudgedFile& file, const AssessOptions& options, const Policy& policy) {
  if (file.error.empty()) try {
      Asset asset = read_asset(file.path);
      file.skipped = asset.skipped;
      const std::vector<std::size_t> first = first_of(asset.primitives);
      const auto begun = std::chrono::steady_clock::now();
      std::map<std::size_t, std::vector<Assessment>> repeated;  // assessments of those that come again
      for (std::size_t i = 0; i < first.size(); ++i) {
        Primitive& primitive = asset.primitives[i];
        std::vector<Assessment> assessments =
            first[i] < i ? repeated[first[i]] : judge_primitive(primitive, options, begun);
        if (first[i] == i && std::count(first.begin(), first.end(), i) > 1) repeated[i] = assessments;
        add_node_findings(primitive, assessments.front().report);
        add(assessments.front().report, finding(Code::indices_left_over, primitive.leftover_indices));
        for (Assessment& j : assessments) {
          apply(policy, j.report, file.ignored);
          file.verdict = std::max(file.verdict, j.report.verdict);
        }
        if (!options.keep_errors) primitive.data = {};
        primitive.other_uvs = {};
        file.primitives.push_back({std::move(primitive), std::move(assessments)});
      }
    } catch (const FileError& e) {
      file.error = e.what();
    } catch (const Error& e) {
      file.error = file.path + ": " + e.what();
    } catch (const std::bad_alloc&) {
      file.error = file.path + ": needs more memory than there is, permitted is what fits";
    }
  if (!file.error.empty()) {
    file.primitives.clear();
    file.verdict = Verdict::fail;
  }
  file.worse = file.verdict > Verdict::pass;
}

Json read_baseline(const std::string& path) {
  std::ifstream stream(path);
  if (!stream) throw FileError(path, "cannot be read, permitted is a report of darboux validate --json");
  try {
    return Json::parse(stream);
  } catch (const Json::exception& e) {
    throw FileError(
        path, "is not JSON, permitted is a report of darboux validate --json: " + std::string(e.what()));
  }
}

namespace {

bool is_pass(const Json& entry, const std::string& path) {
  const std::string verdict = entry.at("verdict");
  if (std::find(verdict_names.begin(), verdict_names.end(), verdict) == verdict_names.end())
    throw FileError(path, "has a verdict '" + verdict + "', permitted are " +
                              joined({verdict_names.begin(), verdict_names.end()}));
  return verdict == "pass" || verdict == "nothing";
}

}  // namespace

void compare_with_baseline(std::vector<JudgedFile>& files, const std::string& path, const Json& baseline) {
  try {
    std::map<std::string, const Json*> then;
    for (const Json& entry : baseline.at("files")) then[entry.at("file").get<std::string>()] = &entry;
    for (JudgedFile& file : files) {
      const auto old = then.find(utf8(file.path));
      if (old == then.end()) continue;
      const Json& entry = *old->second;
      const bool was_unreadable = entry.contains("error");
      if (!file.error.empty() || was_unreadable) {
        file.worse = file.worse && !was_unreadable;
        if (was_unreadable)  // whatever it is now was no better then
          for (JudgedPrimitive& p : file.primitives) {
            p.known_not_pass = p.assessments.size();
            for (const Assessment& j : p.assessments)
              for (const Finding& f : j.report.findings) p.known[std::string(f.code)] = p.count(f.code);
          }
        continue;
      }
      std::map<std::pair<std::size_t, std::size_t>, JudgedPrimitive*> by_number;
      for (JudgedPrimitive& p : file.primitives) by_number[{p.primitive.mesh, p.primitive.primitive}] = &p;
      for (const Json& mesh : entry.at("meshes")) {
        const auto p =
            by_number.find({mesh.at("mesh").get<std::size_t>(), mesh.at("primitive").get<std::size_t>()});
        if (p == by_number.end()) continue;
        p->second->known_not_pass += !is_pass(mesh, path);
        for (const Json& finding : mesh.at("findings")) {
          if (!finding.at("count").is_number_unsigned())
            throw FileError(
                path, "has a count " + finding.at("count").dump() + ", permitted are whole numbers from 0");
          p->second->known[finding.at("code").get<std::string>()] += finding.at("count").get<std::size_t>();
        }
      }
      // What fails has an error, which counts; what is undetermined has none.
      is_pass(entry, path);  // refuses what is no verdict
      file.worse = false;
      for (const JudgedPrimitive& p : file.primitives) {
        file.worse |= p.less_determined();
        for (const Assessment& j : p.assessments)
          for (const Finding& f : j.report.findings)
            file.worse |= f.severity == Severity::error && p.worse(f);
      }
    }
  } catch (const Json::exception& e) {
    throw FileError(path, "is no report of darboux validate --json: " + std::string(e.what()));
  }
}

std::string uv_convention(const MeshFit& fit) {
  return fit.chart == UvChart::own         ? std::string(fit.surface.uv.name)
         : fit.chart == UvChart::projected ? "projected"
                                           : "unknown";
}

std::string place_of(const Primitive& primitive, const Assessment& assessment) {
  std::string text =
      "mesh " + std::to_string(primitive.mesh) + " primitive " + std::to_string(primitive.primitive);
  if (assessment.part) text += " part " + std::to_string(*assessment.part);
  if (!primitive.name.empty()) text += " (" + one_line(primitive.name) + ")";
  return text;
}

}  // namespace darboux
