/// \file work_precision_study.h
/// The study of `darboux work-precision`: study file, presets, jobs; and the input of --compare.
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

/// The settings of `work-precision` as texts, in the notation of its options: the content of a study file.
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

/// The settings of a preset. quick: the defaults; standard: the catalogue, 21 rounds, 8 to 64 rows; full: 51
/// rounds, 8 to 256 rows. Empty for an unknown name.
std::optional<WorkChoices> work_preset(std::string_view name);

/// Overrides `choices` by the settings in a study file (docs/schemas/work-precision-study.schema.json).
/// \throws FileError with the path of the invalid key
void read_work_study(const std::string& file, WorkChoices& choices);

/// Everything on which the results depend, except for the machine: all settings.
Json work_identity(const WorkOptions& options);

/// Runs or resumes the jobs of a shard. The samples are complete if the shard is 1/1. \param jobs_done
/// receives the number of jobs of the shard with results
std::vector<WorkSample> run_work_study(const WorkOptions& options, const StudyIdentity& identity,
                                       const StudyOptions& study, std::size_t& jobs_done,
                                       const std::function<void(double)>& progress);

/// A document printed by `work-precision --json`.
struct WorkDocument {
  std::vector<WorkSample> samples;
  Json study;                    ///< work_identity()
  std::string version, machine;  ///< of provenance
};
/// \throws FileError if it is not such a document
WorkDocument read_work_document(const std::string& file);

/// The differences between two runs that may explain different results: "version: 1 before, 2 after". \throws
/// FileError, for the second file, if the runs are not comparable: different seed, points, numbers of checked
/// points, or content of an input that both read
std::vector<std::string> compare_studies(const WorkDocument& before, const WorkDocument& after,
                                         const std::string& after_file);

}  // namespace darboux
