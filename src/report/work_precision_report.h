/// \file work_precision_report.h
/// The samples of `darboux work-precision`, and two runs compared, as JSON, CSV, text, tables, pictures.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/work_precision.h>

#include "provenance.h"

namespace darboux {

/// As `darboux work-precision --json` prints them; a number that does not exist is null.
nlohmann::ordered_json work_json(const std::vector<WorkSample>& samples);
/// Reads a sample from that JSON. \throws nlohmann::json::exception, ParameterError for another document
WorkSample work_sample_of(const nlohmann::ordered_json& json);

/// One row per sample, with a header.
std::string work_csv(const std::vector<WorkSample>& samples);

/// For a terminal: per surface and mesh, one line per method that no other of its family dominates, with the
/// front marked; then what failed, and a summary sentence.
std::string work_text(const std::vector<WorkSample>& samples, const WorkAxes& axes);
/// The same as Markdown.
std::string work_markdown(const std::vector<WorkSample>& samples, const WorkAxes& axes,
                          const Provenance& provenance);
/// "66 methods timed on 4 surfaces, none failed"
std::string work_summary(const std::vector<WorkSample>& samples);

/// A self-contained HTML page: any metric against any, per surface and mesh. Works offline; without scripts
/// the table of fronts is still shown.
std::string work_page(const std::vector<WorkSample>& samples, const WorkAxes& axes,
                      const Provenance& provenance);
/// A picture: a panel per surface and mesh, at most twelve; a mark per method, hollow in single precision;
/// the front as a line.
std::string work_picture(const std::vector<WorkSample>& samples, const WorkAxes& axes);

/// Two runs compared, as `--compare --json` prints them.
nlohmann::ordered_json comparisons_json(const std::vector<WorkComparison>& comparisons);
/// Text for a terminal: the differences, then a summary.
std::string comparisons_text(const std::vector<WorkComparison>& comparisons, double tolerance);

// ---- shared by the page and the tables --------------------------------------------------------------------

/// Samples of one surface at points, or on one family of meshes of it, which are compared with one another.
struct WorkGroup {
  std::string surface, name;  ///< the specification; a name that distinguishes it from the others
  WorkDomain domain;
  std::string mesh;
  std::vector<const WorkSample*> samples;

  /// "torus at points", "torus on jittered meshes"
  std::string title() const;
};
/// In the order of the samples.
std::vector<WorkGroup> work_groups(const std::vector<WorkSample>& samples);

/// "mikktspace, 64 rows"
std::string work_method_name(const WorkSample& sample);
/// The values of a metric for people: "2.4 ns", "1.3e-16".
std::string work_value(std::string_view metric, double value);
/// "nanoseconds per point", "largest angle of t, b, n, radians"
std::string work_axis(std::string_view metric, WorkDomain domain);

}  // namespace darboux
