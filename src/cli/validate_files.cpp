#include "validate_files.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <tuple>
#include <utility>

#include <fnmatch.h>

#include "assets/triangles_beside.h"
#include "base/extension.h"
#include "io/json_cursor.h"

namespace darboux {
namespace {

namespace fs = std::filesystem;

bool is_mesh_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  const auto& known = asset_extensions();
  return std::find(known.begin(), known.end(), extension) != known.end();
}

// The patterns of --exclude.
class Excluded {
 public:
  explicit Excluded(const std::vector<std::string>& globs) {
    for (const std::string& given : globs) {
      std::string glob = given;
      while (glob.starts_with("./")) glob.erase(0, glob.find_first_not_of('/', 1));
      while (glob.size() > 1 && glob.ends_with('/')) glob.pop_back();
      patterns_.push_back({given, glob});
    }
  }
  // Whether a file or folder is excluded; records which patterns match.
  bool operator()(const fs::path& relative) {
    bool any = false;
    const std::string text = relative.generic_string();
    for (Pattern& p : patterns_)
      if (fnmatch(p.glob.c_str(), text.c_str(), 0) == 0) any = p.used = true;
    return any;
  }
  std::vector<std::string> unused() const {
    std::vector<std::string> result;
    for (const Pattern& p : patterns_)
      if (!p.used) result.push_back(p.given);
    return result;
  }

 private:
  struct Pattern {
    std::string given, glob;
    bool used = false;
  };
  std::vector<Pattern> patterns_;
};

// The mesh files in a folder and its subfolders; for a folder that cannot be listed, the error. Returns
// whether anything was excluded.
bool list_folder(const fs::path& folder, const fs::path& root, Excluded& excluded,
                 std::vector<AssessedFile>& found) {
  bool left_out = false;
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    std::error_code unknown;
    const bool is_folder = i->is_directory(unknown) && !i->is_symlink(unknown);
    if (!is_folder && !(is_mesh_file(i->path()) && i->is_regular_file(unknown))) continue;
    if (excluded(i->path().lexically_relative(root)))
      left_out = true;
    else if (is_folder)
      left_out |= list_folder(i->path(), root, excluded, found);
    else
      found.push_back({.path = i->path().string()});
  }
  if (error)
    found.push_back(
        {.path = folder.string(),
         .error =
             FileError(folder.string(), expected_got("a folder that can be read", error.message())).what()});
  return left_out;
}

void list_folder(const std::string& folder, Excluded& excluded, std::vector<AssessedFile>& files) {
  std::vector<AssessedFile> found;
  const bool left_out = list_folder(fs::path(folder), fs::path(folder), excluded, found);
  const std::string extensions = joined({asset_extensions().begin(), asset_extensions().end()});
  if (found.empty())
    found.push_back(
        {.path = folder,
         .error = FileError(folder, left_out ? "expected mesh files that --exclude leaves, got none (of " +
                                                   extensions + ")"
                                             : "expected mesh files (" + extensions + "), got none")
                      .what()});
  std::sort(found.begin(), found.end(),
            [](const AssessedFile& a, const AssessedFile& b) { return a.path < b.path; });
  files.insert(files.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
}

// Node transforms change what a renderer shows, not what the mesh stores, so they cause only findings.
struct NodeFindings {
  std::size_t mirrored = 0, sheared = 0;

  explicit NodeFindings(const Instances& instances) {
    for (const Eigen::Matrix4d& world : instances) {
      const Eigen::Matrix3d m = world.topLeftCorner<3, 3>();
      const Eigen::Matrix3d gram = m.transpose() * m;
      const double scale = gram.trace() / 3;
      mirrored += m.determinant() < 0;
      sheared += (gram - scale * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-5 * scale;
    }
  }

  void add_to(MeshReport& report) const {
    add(report, finding(Code::node_mirrored, mirrored));
    add(report, finding(Code::node_scale_not_uniform, sheared));
  }
};

// The report under the policy. Returns the library's severity of each finding.
std::vector<Severity> apply(const Policy& policy, MeshReport& report,
                            std::map<std::string, std::size_t>& ignored) {
  struct Graded {
    Finding finding;
    Severity own;
  };
  std::vector<Graded> graded;
  const auto grade = [&](Finding f) {
    if (policy.ignore.contains(code_of(f))) {
      ignored[std::string(f.code)] += f.count;
      return;
    }
    const Severity own = f.severity;
    if (const auto asked = policy.severity.find(code_of(f)); asked != policy.severity.end())
      f.severity = asked->second;
    graded.push_back({std::move(f), own});
  };
  for (Finding& f : report.findings) grade(std::move(f));
  // Errors that exist only by policy must not hide that nothing was assessed.
  const auto is_own_error = [](const Graded& g) {
    return g.own == Severity::error && g.finding.severity == Severity::error;
  };
  if (report.without_errors == Verdict::undetermined &&
      std::none_of(graded.begin(), graded.end(), is_own_error))
    grade(finding(Code::undetermined, 1));
  for (Graded& g : graded)
    if (policy.strict && g.finding.severity == Severity::warning) g.finding.severity = Severity::error;
  std::stable_sort(graded.begin(), graded.end(),
                   [](const Graded& a, const Graded& b) { return a.finding.severity > b.finding.severity; });
  report.findings.clear();
  std::vector<Severity> own;
  for (Graded& g : graded) {
    report.findings.push_back(std::move(g.finding));
    own.push_back(g.own);
  }
  const bool any_error = !graded.empty() && report.findings.front().severity == Severity::error;
  report.verdict = any_error ? Verdict::fail : report.without_errors;
  return own;
}

bool is_undetermined(const Assessment& assessment) {
  const auto& findings = assessment.report.findings;
  return assessment.report.verdict == Verdict::undetermined ||
         std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return code_of(f) == Code::undetermined; });
}

}  // namespace

std::size_t AssessedPrimitive::count(Code code, Severity own) const {
  std::size_t sum = 0;
  each_finding([&](const Assessment&, const Finding& f, Severity of_library) {
    sum += code_of(f) == code && of_library == own ? f.count : 0;
  });
  return sum;
}

std::size_t AssessedPrimitive::known_count(Code code, Severity own) const {
  const auto at = known.find({code, own});
  return at == known.end() ? 0 : at->second;
}

bool AssessedPrimitive::worse(const Finding& finding, Severity own) const {
  const Code code = code_of(finding);
  if (code == Code::undetermined) return less_determined();
  if (own == Severity::error) return count(code, own) > known_count(code, own);
  std::size_t now = 0, then = 0;
  for (const Severity s : {Severity::info, Severity::warning, Severity::error}) {
    now += count(code, s);
    then += known_count(code, s);
  }
  return now > then;
}

bool AssessedPrimitive::less_determined() const {
  return static_cast<std::size_t>(std::count_if(assessments.begin(), assessments.end(), is_undetermined)) >
         known_not_pass;
}

std::vector<AssessedFile> files_of(const std::vector<std::string>& arguments,
                                   const std::vector<std::string>& exclude,
                                   std::vector<std::string>& unused) {
  Excluded excluded(exclude);
  std::vector<AssessedFile> files;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (fs::is_directory(argument, error))
      list_folder(argument, excluded, files);
    else
      files.push_back({.path = argument});
  }
  unused = excluded.unused();
  return files;
}

namespace {

// Orders primitives by the bits of everything that their assessments depend on.
struct ByContent {
  const std::vector<Primitive>& primitives;
  const std::vector<Mesh>& beside;

  auto few(std::size_t i) const {
    const Primitive& p = primitives[i];
    const Mesh& m = p.data;
    const HalfSteps& s = m.half_steps;
    return std::tuple(m.positions.size(), m.triangles.size(), m.normals.size(), m.uvs.size(),
                      m.tangents.size(), p.other_uvs.size(), s.position, s.normal, s.uv, s.tangent,
                      p.names_uv_set, p.texture_transform, beside[i].positions.size(),
                      beside[i].triangles.size());
  }

  bool operator()(std::size_t i, std::size_t j) const {
    const Primitive &p = primitives[i], &q = primitives[j];
    if (const auto a = few(i), b = few(j); a != b) return a < b;
    int order = 0;
    const auto compare = [&order](const auto& a, const auto& b) {
      if (order == 0 && !a.empty()) order = std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]);
    };
    for (const auto& [a, b] : {std::pair(&p.data, &q.data), std::pair(&beside[i], &beside[j])}) {
      compare(a->triangles, b->triangles);
      compare(a->positions, b->positions);
      compare(a->normals, b->normals);
      compare(a->uvs, b->uvs);
      compare(a->tangents, b->tangents);
    }
    for (std::size_t k = 0; order == 0 && k < p.other_uvs.size(); ++k) {
      order = p.other_uvs[k].first - q.other_uvs[k].first;
      compare(p.other_uvs[k].second, q.other_uvs[k].second);  // one uv per vertex, as the other has
    }
    return order < 0;
  }
};

// For each primitive, the first one with the same content. \param beside triangles_beside() them
std::vector<std::size_t> first_of(const std::vector<Primitive>& primitives, const std::vector<Mesh>& beside) {
  std::set<std::size_t, ByContent> kinds{ByContent{primitives, beside}};
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < primitives.size(); ++i) result.push_back(*kinds.insert(i).first);
  return result;
}

// \param begun when the file was begun; its primitives share the budget
// \param history parts of its earlier primitives in which no surface was found
std::vector<Assessment> assess_primitive(const Primitive& primitive, const Mesh& beside,
                                         const AssessOptions& options,
                                         std::chrono::steady_clock::time_point begun,
                                         SearchHistory& history) {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
  AssessOptions with_uvs = options;
  if (options.budget) with_uvs.budget = std::fmax(*options.budget - spent.count(), 0);
  with_uvs.history = &history;
  with_uvs.other_uvs = primitive.other_uvs;
  with_uvs.names_uv_set = primitive.names_uv_set;
  with_uvs.sign = primitive.sign;
  with_uvs.texture_transform = primitive.texture_transform;
  with_uvs.beside = &beside;
  return assess_parts(primitive.data, with_uvs);
}

// If a primitive passes, undetermined primitives of its mesh that adjoin another one do not make the mesh
// undetermined; parts are treated alike. \param beside triangles_beside() them
void close_what_is_left(std::vector<AssessedPrimitive>& primitives, const std::vector<Mesh>& beside) {
  std::set<std::size_t> passing;
  for (const AssessedPrimitive& p : primitives)
    for (const Assessment& assessment : p.assessments)
      if (assessment.report.without_errors == Verdict::pass) passing.insert(p.primitive.mesh);
  for (std::size_t i = 0; i < primitives.size(); ++i)
    if (!beside[i].triangles.empty() && passing.count(primitives[i].primitive.mesh) > 0)
      for (Assessment& assessment : primitives[i].assessments) pass_if_undetermined(assessment.report);
}

void skip_unneeded(Asset& asset, std::vector<Mesh>& beside, std::vector<SkippedPrimitive>& skipped) {
  std::vector<Primitive> needed;
  std::vector<Mesh> beside_those;
  for (std::size_t i = 0; i < asset.primitives.size(); ++i) {
    Primitive& p = asset.primitives[i];
    if (p.needs_tangents.value_or(true)) {
      needed.push_back(std::move(p));
      beside_those.push_back(std::move(beside[i]));
    } else {
      skipped.push_back({p.mesh, p.primitive, std::string(unneeded_reason)});
    }
  }
  asset.primitives = std::move(needed);
  beside = std::move(beside_those);
}

}  // namespace

void assess_file(AssessedFile& file, const AssessOptions& options, const Policy& policy,
                 const ReadOptions& read, const std::optional<MapCostOptions>& map_cost) {
  if (file.readable()) try {
      Asset asset = read_asset(file.path, read);
      file.skipped = asset.skipped;
      std::vector<Mesh> beside = triangles_beside(asset.primitives);
      if (policy.only_needed) skip_unneeded(asset, beside, file.skipped);
      const std::vector<std::size_t> first = first_of(asset.primitives, beside);
      const auto begun = std::chrono::steady_clock::now();
      std::vector<std::size_t> count(first.size());
      for (const std::size_t i : first) ++count[i];
      std::map<std::size_t, std::vector<Assessment>> repeated;  // assessments of those that come again
      std::map<std::size_t, NodeFindings> of_mesh;
      SearchHistory history;
      for (std::size_t i = 0; i < first.size(); ++i) {
        Primitive& primitive = asset.primitives[i];
        std::vector<Assessment> assessments =
            first[i] < i ? repeated[first[i]]
                         : assess_primitive(primitive, beside[i], options, begun, history);
        if (first[i] == i && count[i] > 1) repeated[i] = assessments;
        of_mesh.try_emplace(primitive.mesh, primitive.instances)
            .first->second.add_to(assessments.front().report);
        add(assessments.front().report, finding(Code::indices_left_over, primitive.leftover_indices));
        if (primitive.missing_texcoord)
          add(assessments.front().report,
              finding(Code::uv_set_missing, primitive.data.corners(),
                      ": TEXCOORD_" + std::to_string(*primitive.missing_texcoord)));
        if (assessments.front().report.verdict != Verdict::nothing)
          add(assessments.front().report, finding(Code::morph_targets_not_judged, primitive.morph_targets));
        std::vector<AssessedMapCost> costs;
        for (const Assessment& j : assessments)
          if (map_cost) costs.push_back(map_cost_of(primitive, j, *map_cost));
        if (!options.keep_errors) primitive.data = {};
        primitive.other_uvs = {};
        file.primitives.push_back({std::move(primitive), std::move(assessments), {}, std::move(costs)});
      }
      close_what_is_left(file.primitives, beside);
      std::vector<NamedReport> parts;
      for (AssessedPrimitive& p : file.primitives)
        for (Assessment& j : p.assessments) parts.push_back({place_of(p.primitive, j), &j.report});
      compare_conventions(parts);
      for (AssessedPrimitive& p : file.primitives)
        for (Assessment& j : p.assessments) {
          p.own_severities.push_back(apply(policy, j.report, file.ignored));
          file.verdict = std::max(file.verdict, j.report.verdict);
        }
    } catch (const std::exception&) {
      file.error = error_of(file.path);
    }
  if (!file.readable()) {
    file.primitives.clear();
    file.verdict = Verdict::fail;
  }
  file.worse = file.verdict > Verdict::pass;
}

Json read_baseline(const std::string& path) {
  return io::parse_json(path, io::read_file(path));
}

namespace {

using io::JsonCursor;

// The enumerator with this name.
template <class E, std::size_t N>
E enumerator(const JsonCursor& name, const std::array<std::string_view, N>& names) {
  const auto found = std::find(names.begin(), names.end(), name.text());
  if (found == names.end()) name.fail("one of " + joined({names.begin(), names.end()}));
  return static_cast<E>(found - names.begin());
}

Verdict verdict_of(const JsonCursor& entry) {
  return enumerator<Verdict>(entry.at("verdict"), verdict_names);
}

// Adds what the baseline contains about a mesh or part.
void add_known(AssessedPrimitive& p, const JsonCursor& mesh) {
  const Verdict verdict = verdict_of(mesh);
  p.known_not_pass += verdict > Verdict::pass;
  bool says_undetermined = false;
  const JsonCursor findings = mesh.at("findings");
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const JsonCursor finding = findings.at(i);
    const std::uint64_t count = finding.at("count").integer();
    const std::optional<Code> code = code_named(finding.at("code").text());
    const auto own = enumerator<Severity>(
        finding.at(finding.has("own_severity") ? "own_severity" : "severity"), severity_names);
    if (!code) continue;  // of another version
    p.known[{*code, own}] += count;
    says_undetermined |= *code == Code::undetermined;
  }
  // Reports of earlier versions have only the verdict for this.
  if (verdict == Verdict::undetermined && !says_undetermined)
    ++p.known[{Code::undetermined, Severity::warning}];
}

void compare(AssessedFile& file, const JsonCursor& entry) {
  const bool was_unreadable = entry.has("error");
  if (!file.readable() || was_unreadable) {
    file.worse = file.worse && !was_unreadable;
    if (was_unreadable)  // whatever it is now was no better then
      for (AssessedPrimitive& p : file.primitives) {
        p.known_not_pass = p.assessments.size();
        p.each_finding([&](const Assessment&, const Finding& f, Severity own) {
          p.known[{code_of(f), own}] += f.count;
        });
      }
    return;
  }
  std::map<std::pair<std::size_t, std::size_t>, AssessedPrimitive*> by_number;
  for (AssessedPrimitive& p : file.primitives) by_number[{p.primitive.mesh, p.primitive.primitive}] = &p;
  const JsonCursor meshes = entry.at("meshes");
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const JsonCursor mesh = meshes.at(i);
    const auto p = by_number.find({mesh.at("mesh").integer(), mesh.at("primitive").integer()});
    if (p != by_number.end()) add_known(*p->second, mesh);
  }
  // A file that fails has an error, which counts; an undetermined one has none.
  const bool left_out = std::any_of(file.skipped.begin(), file.skipped.end(),
                                    [](const SkippedPrimitive& s) { return s.reason == unneeded_reason; });
  file.lost = verdict_of(entry) == Verdict::pass && file.verdict == Verdict::nothing && !left_out;
  file.worse = file.lost;
  for (const AssessedPrimitive& p : file.primitives) {
    file.worse |= p.less_determined();
    p.each_finding([&](const Assessment&, const Finding& f, Severity own) {
      file.worse |= f.severity == Severity::error && p.worse(f, own);
    });
  }
}

}  // namespace

void compare_with_baseline(std::vector<AssessedFile>& files, const std::string& path, const Json& baseline) {
  const JsonCursor then = JsonCursor::with_pointers(path, baseline).at("files");
  std::map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < then.size(); ++i) place[then.at(i).at("file").text()] = i;
  for (AssessedFile& file : files)
    if (const auto old = place.find(utf8(file.path)); old != place.end()) compare(file, then.at(old->second));
}

std::string uv_convention(const MeshFit& fit) {
  return fit.chart == UvChart::own         ? std::string(fit.surface.uv.name)
         : fit.chart == UvChart::projected ? "projected"
                                           : "unknown";
}

ReferenceKind reference_of_classes(const Assessment& assessment) {
  const MeshReport& report = assessment.report;
  if (std::none_of(report.classes.begin(), report.classes.end(),
                   [](const ClassReport& c) { return c.normal_deg || c.tangent_deg || c.bitangent_deg; }))
    return ReferenceKind::none;
  return assessment.fit && assessment.fit->fits ? ReferenceKind::analytic
         : report.local                         ? ReferenceKind::local
                                                : ReferenceKind::mikktspace;
}

std::string place_of(const Primitive& primitive, const Assessment& assessment) {
  std::string text = primitive_text(primitive.mesh, primitive.primitive);
  if (assessment.part) text += " part " + std::to_string(*assessment.part);
  if (!primitive.name.empty()) text += " (" + one_line(primitive.name) + ")";
  return text;
}

}  // namespace darboux
