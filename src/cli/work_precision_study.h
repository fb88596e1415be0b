/// \file work_precision_study.h
/// `darboux work-precision` as a study: its file, its presets, its jobs; and what --compare reads.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/work_precision.h>

#include "command.h"
#include "report_command.h"

namespace darboux {

/// The choices of `work-precision` as texts, in the notation of its options: what a study file may hold.
/// Empty: all.
struct WorkChoices {
  std::vector<std::string> surfaces{"torus", "sphere", "klein-bottle", "bspline-patch"}, methods,
      meshes{"jittered"};
  std::vector<int> resolutions{8, 16, 32};
  int rounds = 11, points = 4096, checked = 1000;
  double timeout = 10;
  std::uint64_t seed = 1;
};

inline constexpr int most_rounds = 10000, most_work_points = 10000000, finest_work_rows = 1024;

/// quick: the choices as they are; standard: the catalogue, 21 rounds, 8 to 64 rows; full: 51 rounds, 8 to
/// 256 rows. Nothing for another name.
std::optional<WorkChoices> work_preset(std::string_view name);

/// Overrides `choices` by what a study file says: docs/schemas/work-precision-study.schema.json.
/// \throws FileError, with the path of the key that is wrong
void read_work_study(const std::string& file, WorkChoices& choices);

/// All that the results depend on but the machine, every choice spelt out.
Json work_identity(const WorkOptions& options);

/// Runs the jobs, or resumes them; the samples are those of the whole when the shard is 1/1.
/// \param jobs_done how many jobs of the shard have results now
std::vector<WorkSample> run_work_study(const WorkOptions& options, const StudyIdentity& identity,
                                       const StudyOptions& study, std::size_t& jobs_done,
                                       const std::function<void(double)>& progress);

/// A document that `work-precision --json` printed.
struct WorkDocument {
  std::vector<WorkSample> samples;
  Json study;                    ///< work_identity()
  std::string version, machine;  ///< of provenance
};
/// \throws FileError for another one
WorkDocument read_work_document(const std::string& file);

/// The differences between two runs that may explain different results: "version: 1 before, 2 after". \throws
/// FileError, of the second file, where they asked different questions: another seed, other points, others
/// checked, another content of an input that both read
std::vector<std::string> compare_studies(const WorkDocument& before, const WorkDocument& after,
                                         const std::string& after_file);

}  // namespace darboux
