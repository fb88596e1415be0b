/// \file converge_study.h
/// The study of `darboux converge`: study file, presets, jobs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/converge.h>

#include "command.h"
#include "report_command.h"

namespace darboux {

/// The settings of `converge` as texts, in the notation of its options: the content of a study file.
struct ConvergeChoices {
  std::vector<std::string> surfaces{"torus:major_radius=1,minor_radius=0.4", "sphere", "cylinder"};
  std::vector<std::string> methods;  ///< empty: all
  std::vector<std::string> meshes{"jittered", "regular", "sheared"};
  std::vector<int> resolutions{8, 16, 32, 64, 128};
  double v_first = 0, v_last = 1;
  std::uint64_t seed = 1;
  int seeds = 3;
};

inline constexpr int finest_rows = 1024;  ///< 4 million triangles; their frames take a gigabyte
inline constexpr int most_seeds = 1000;

/// The settings of a preset. quick: the defaults; standard: six surfaces, six families of meshes, 16 to 512
/// rows; full: 8 to 1024. Empty for an unknown name.
std::optional<ConvergeChoices> preset_named(std::string_view name);

/// Overrides `choices` by the settings in a study file (docs/schemas/converge-study.schema.json). \throws
/// FileError with the path of the invalid key
void read_converge_study(const std::string& file, ConvergeChoices& choices);

/// Everything on which the results depend: all settings, and a hash of each file from which a surface is
/// read.
Json converge_identity(const ConvergeOptions& options);

/// Runs or resumes the jobs of a shard. The studies are complete if the shard is 1/1. \param jobs_done
/// receives the number of jobs of the shard with results
std::vector<Study> run_converge_study(const ConvergeOptions& options, const StudyIdentity& identity,
                                      const StudyOptions& study, std::size_t& jobs_done,
                                      const std::function<void(double)>& progress);

}  // namespace darboux
