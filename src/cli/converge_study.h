/// \file converge_study.h
/// `darboux converge` as a study: its file, its presets, its jobs.
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

/// The choices of `converge` as texts, in the notation of its options: what a study file may hold.
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

/// quick: the choices as they are; standard: six surfaces, six families of meshes, 16 to 512 rows; full: 8 to
/// 1024. Nothing for another name.
std::optional<ConvergeChoices> preset_named(std::string_view name);

/// Overrides `choices` by what a study file says: docs/schemas/converge-study.schema.json.
/// \throws FileError, with the path of the key that is wrong
void read_converge_study(const std::string& file, ConvergeChoices& choices);

/// All that the results depend on, every choice spelt out, with a hash of each file that a surface is read
/// from.
Json converge_identity(const ConvergeOptions& options);

/// Runs the jobs, or resumes them; the studies are those of the whole when the shard is 1/1.
/// \param jobs_done how many jobs of the shard have results now
std::vector<Study> run_converge_study(const ConvergeOptions& options, const StudyIdentity& identity,
                                      const StudyOptions& study, std::size_t& jobs_done,
                                      const std::function<void(double)>& progress);

}  // namespace darboux
