/// \file validate_files.h
/// The files that validate is given, assessed; what it says of them goes out as text, JSON, SARIF and JUnit.
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

/// Numbers of findings by code and severity, the library's, whatever an option made of it.
using FindingCounts = std::map<std::pair<Code, Severity>, std::size_t>;

/// What a normal map would cost.
struct AssessedMapCost {
  std::optional<MapCost> cost{};
  std::string why{};  ///< there is none
};

struct AssessedPrimitive {
  Primitive primitive;  ///< without its data, unless errors are kept
  std::vector<Assessment> assessments;
  /// The library's severity of each finding of each assessment.
  std::vector<std::vector<Severity>> own_severities{};
  std::vector<AssessedMapCost> map_costs{};  ///< of each assessment, where it was asked for
  FindingCounts known{};                     ///< in the baseline
  std::size_t known_not_pass = 0;            ///< meshes and parts that did not pass in the baseline

  /// Over all parts.
  std::size_t count(Code code, Severity own) const;
  std::size_t known_count(Code code, Severity own) const;
  /// Whether an error counts against a run with a baseline. The library's own errors are compared with its
  /// own errors in the baseline; findings that an option made errors, with all findings of that code there.
  /// UNDETERMINED goes by less_determined().
  bool worse(const Finding& finding, Severity own) const;
  /// Whether more parts are undetermined than did not pass in the baseline.
  bool less_determined() const;

  /// \param f called with each assessment, each of its findings, and the library's severity of that
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
  std::map<std::string, std::size_t> ignored{};  ///< counts of findings that were dropped, by code
  Verdict verdict = Verdict::nothing;            ///< the worst of its meshes and parts
  bool lost = false;  ///< it passed in the baseline, and there is nothing to assess now
  /// Whether it counts against the run: its verdict is neither pass nor nothing, or it could not be read;
  /// and, where there is a baseline, it was better there.
  bool worse = false;

  bool readable() const { return error.empty(); }
};

/// The files that arguments name, a folder standing for all mesh files in it and in its folders, in the order
/// of their names. What cannot be listed has an error. \param exclude patterns as of fnmatch(3), of paths
/// relative to the folder; * crosses folders, and what matches a folder matches all that is in it
/// \param unused becomes those patterns that matched nothing
std::vector<AssessedFile> files_of(const std::vector<std::string>& arguments,
                                   const std::vector<std::string>& exclude, std::vector<std::string>& unused);

/// How findings count, whatever the library says.
struct Policy {
  std::map<Code, Severity> severity{};
  std::set<Code> ignore{};   ///< codes that are dropped but for their counts
  bool strict = false;       ///< warnings are errors, UNDETERMINED too
  bool only_needed = false;  ///< primitives whose materials read no tangents are skipped
};

/// Why --only needed skips a primitive.
inline constexpr std::string_view unneeded_reason = "the material reads no tangents (--only needed)";

/// Reads and assesses one file. What is undetermined has the finding UNDETERMINED.
/// \param map_cost what of normal_map_cost() is asked for
void assess_file(AssessedFile& file, const AssessOptions& options, const Policy& policy,
                 const ReadOptions& read, const std::optional<MapCostOptions>& map_cost = {});

/// What --normal-map asks for, nothing where it is empty. \throws ParameterError, FileError for more texels
/// than a map can have, or than --max-memory holds
std::optional<MapCostOptions> map_cost_options(const std::string& size, const ReadOptions& read);

/// Of a mesh or part whose surface is known through its own uvs.
AssessedMapCost map_cost_of(const Primitive& primitive, const Assessment& assessment,
                            const MapCostOptions& options);
Json map_cost_json(const std::optional<MapCost>& cost);
void print_map_cost(const AssessedMapCost& of);

/// An earlier report, `darboux validate --json`. \throws FileError
Json read_baseline(const std::string& path);

/// Makes only what is worse than in the baseline count against the run: an error that is new or more frequent
/// in a primitive (AssessedPrimitive::worse()), a primitive of which more parts are undetermined than did not
/// pass then, a file that passed then and has nothing to assess now, one that could be read then. \param path
/// where it was read from, for messages \throws FileError where it is no such report
void compare_with_baseline(std::vector<AssessedFile>& files, const std::string& path, const Json& baseline);

/// "mesh 0 primitive 1 part 2 (name)"
std::string place_of(const Primitive& primitive, const Assessment& assessment);

/// What the angles of a report's classes are measured against: analytic, local or mikktspace; none where
/// there are none.
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

/// Whether a truth with an uncertainty decided: that of a surface, or of the neighbours.
inline bool has_uncertainty(const MeshReport& report) {
  return report.reference == ReferenceKind::analytic || report.reference == ReferenceKind::local;
}

/// Whether tangents were compared with it.
inline bool has_tangent_angles(const MeshReport& report) {
  return std::any_of(report.classes.begin(), report.classes.end(),
                     [](const ClassReport& c) { return c.tangent_deg.has_value(); });
}

/// What stored uvs mean on the surface: "flip v", "projected".
std::string uv_convention(const MeshFit& fit);

Json report_json(const std::vector<AssessedFile>& files, bool with_baseline);

/// A short table per mesh and part; only the findings, if there are many meshes and parts, or many files, and
/// no details are asked for. \param quiet a line for each file, its verdict
void print_text(const std::vector<AssessedFile>& files, bool with_baseline, bool details, bool quiet);

/// Static Analysis Results Interchange Format 2.1.0, with what GitHub's code scanning asks for.
/// \param with_baseline whether to say what is new, unchanged or updated
Json sarif(const std::vector<AssessedFile>& files, bool with_baseline);

/// Annotations of GitHub's workflows, a line per error and warning, at most some dozens. With a baseline,
/// only what has become more frequent.
void print_github(const std::vector<AssessedFile>& files, bool with_baseline);

/// JUnit's XML, one test case per mesh or part; what counts against the run is a failure.
std::string junit(const std::vector<AssessedFile>& files, bool with_baseline);

}  // namespace darboux
