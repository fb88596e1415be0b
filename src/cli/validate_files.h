/// \file validate_files.h
/// Assesses the files given to `validate`, and writes the results as text, JSON, SARIF and JUnit.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/assess.h>
#include <darboux/io.h>
#include <darboux/map_cost.h>

#include "command.h"
#include "validate/findings.h"

namespace darboux {

/// Numbers of findings by code and original severity (the library's, before options change it).
using FindingCounts = std::map<std::pair<Code, Severity>, std::size_t>;

/// The cost of a normal map.
struct AssessedMapCost {
  std::optional<MapCost> cost{};
  std::string why{};  ///< why there is no result
};

struct AssessedPrimitive {
  Primitive primitive;  ///< without its data, unless errors are kept
  std::vector<Assessment> assessments;
  /// The original severity of each finding of each assessment.
  std::vector<std::vector<Severity>> own_severities{};
  std::vector<AssessedMapCost> map_costs{};  ///< of each assessment, if requested
  FindingCounts known{};                     ///< in the baseline
  std::size_t known_not_pass = 0;            ///< meshes and parts that did not pass in the baseline

  /// Over all parts.
  std::size_t count(Code code, Severity own) const;
  std::size_t known_count(Code code, Severity own) const;
  /// Whether an error counts as worse than in the baseline. Original errors are compared with original errors
  /// in the baseline; findings that an option turned into errors, with all findings of that code. For
  /// UNDETERMINED, less_determined() decides.
  bool worse(const Finding& finding, Severity own) const;
  /// Whether more parts are undetermined than did not pass in the baseline.
  bool less_determined() const;

  /// \param f called with each assessment, each of its findings, and the original severity of the finding
  template <class F>
  void each_finding(F f) const {
    for (std::size_t a = 0; a < assessments.size(); ++a)
      for (std::size_t k = 0; k < assessments[a].report.findings.size(); ++k)
        f(assessments[a], assessments[a].report.findings[k], own_severities[a][k]);
  }
};

struct AssessedFile {
  std::string path;
  std::string error{};  ///< empty where the file could be read
  std::vector<AssessedPrimitive> primitives{};
  std::vector<SkippedPrimitive> skipped{};
  std::map<std::string, std::size_t> ignored{};  ///< counts of ignored findings, by code
  Verdict verdict = Verdict::nothing;            ///< the worst of its meshes and parts
  bool lost = false;  ///< it passed in the baseline, and now there is nothing to assess
  /// Whether it makes the run fail: its verdict is neither pass nor nothing, or it cannot be read; and, with
  /// a baseline, it was better there.
  bool worse = false;

  bool readable() const { return error.empty(); }
};

/// The files named by arguments. A folder stands for all mesh files in it and its subfolders, in the order of
/// their names. A folder that cannot be listed has an error. \param exclude patterns of fnmatch(3) for paths
/// relative to the folder; * also matches /, and a pattern that matches a folder excludes its content \param
/// unused receives the patterns that matched nothing
std::vector<AssessedFile> files_of(const std::vector<std::string>& arguments,
                                   const std::vector<std::string>& exclude, std::vector<std::string>& unused);

/// Options that change how findings count.
struct Policy {
  std::map<Code, Severity> severity{};
  std::set<Code> ignore{};   ///< codes that are suppressed except for their counts
  bool strict = false;       ///< warnings are errors, UNDETERMINED too
  bool only_needed = false;  ///< primitives whose materials read no tangents are skipped
};

/// Why --only needed skips a primitive.
inline constexpr std::string_view unneeded_reason = "the material reads no tangents (--only needed)";

/// Reads and assesses one file. Undetermined meshes and parts have the finding UNDETERMINED. \param map_cost
/// options of normal_map_cost(), if requested
void assess_file(AssessedFile& file, const AssessOptions& options, const Policy& policy,
                 const ReadOptions& read, const std::optional<MapCostOptions>& map_cost = {});

/// The options for --normal-map; empty if it was not given. \throws ParameterError, FileError for more texels
/// than a map can have, or than --max-memory holds
std::optional<MapCostOptions> map_cost_options(const std::string& size, const ReadOptions& read);

/// The cost for a mesh or part whose surface was found through its uvs.
AssessedMapCost map_cost_of(const Primitive& primitive, const Assessment& assessment,
                            const MapCostOptions& options);
Json map_cost_json(const std::optional<MapCost>& cost);
void print_map_cost(const AssessedMapCost& of);

/// An earlier report, `darboux validate --json`. \throws FileError
Json read_baseline(const std::string& path);

/// Makes only regressions count: an error that is new or more frequent in a primitive
/// (AssessedPrimitive::worse()); a primitive with more undetermined parts than it had parts that did not
/// pass; a file that passed and now has nothing to assess; a file that can no longer be read. \param path the
/// path of the baseline, for messages \throws FileError if it is not such a report
void compare_with_baseline(std::vector<AssessedFile>& files, const std::string& path, const Json& baseline);

/// "mesh 0 primitive 1 part 2 (name)"
std::string place_of(const Primitive& primitive, const Assessment& assessment);

/// The reference of the angles in a report's classes: analytic, local or mikktspace; none if there are no
/// angles.
ReferenceKind reference_of_classes(const Assessment& assessment);

inline std::string_view name_of(Verdict verdict) {
  return name_in(verdict_names, verdict);
}
inline std::string_view name_of(Severity severity) {
  return name_in(severity_names, severity);
}
inline std::string_view name_of(ReferenceKind reference) {
  return name_in(reference_names, reference);
}
inline std::string_view name_of(HandednessConvention convention) {
  return name_in(handedness_convention_names, convention);
}
inline std::string_view name_of(MikkVariant variant) {
  return name_in(mikk_variant_names, variant);
}
inline std::string_view name_of(VertexClass vertex_class) {
  return name_in(vertex_class_names, vertex_class);
}

/// Whether the deciding reference has an uncertainty: a surface, or polynomials through the neighbours.
inline bool has_uncertainty(const MeshReport& report) {
  return report.reference == ReferenceKind::analytic || report.reference == ReferenceKind::local;
}

/// Whether tangents were compared with that reference.
inline bool has_tangent_angles(const MeshReport& report) {
  return std::any_of(report.classes.begin(), report.classes.end(),
                     [](const ClassReport& c) { return c.tangent_deg.has_value(); });
}

/// The relation of the stored uvs to the surface: "flip v", "projected".
std::string uv_convention(const MeshFit& fit);

Json report_json(const std::vector<AssessedFile>& files, bool with_baseline);

/// Prints a short table per mesh and part; only the findings if there are many files, meshes or parts and no
/// details are requested. \param quiet one line per file, its verdict
void print_text(const std::vector<AssessedFile>& files, bool with_baseline, bool details, bool quiet);

/// SARIF (Static Analysis Results Interchange Format) 2.1.0, with the properties that GitHub code scanning
/// requires. \param with_baseline whether to state what is new, unchanged or updated
Json sarif(const std::vector<AssessedFile>& files, bool with_baseline);

/// Annotations for GitHub workflows, one line per error and warning, at most some dozens. With a baseline,
/// only increases.
void print_github(const std::vector<AssessedFile>& files, bool with_baseline);

/// JUnit XML, one test case per mesh or part. Whatever makes the run fail is a failure.
std::string junit(const std::vector<AssessedFile>& files, bool with_baseline);

}  // namespace darboux
