/// \file stability_study.h
/// `darboux stability` as a study: its file, its presets, its jobs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/stability.h>

#include "command.h"
#include "report_command.h"

namespace darboux {

/// The choices of `stability` as texts, in the notation of its options: what a study file may hold. Empty:
/// all.
struct StabilityChoices {
  std::vector<std::string> surfaces, sweeps, routes;
  int points = 24, samples = 3;
  std::uint64_t seed = 1;
};

inline constexpr int most_points = 10000;  ///< of a sweep, and samples at each

/// quick: the choices as they are; standard: 61 values of x, 8 samples; full: 301, 16. Nothing for another
/// name.
std::optional<StabilityChoices> stability_preset(std::string_view name);

/// Overrides `choices` by what a study file says: docs/schemas/stability-study.schema.json.
/// \throws FileError, with the path of the key that is wrong
void read_stability_study(const std::string& file, StabilityChoices& choices);

/// All that the results depend on, every choice spelt out.
Json stability_identity(const StabilityOptions& options);

/// Runs the jobs, or resumes them; the curves are those of the whole when the shard is 1/1.
/// \param jobs_done how many jobs of the shard have results now
std::vector<StabilityCurve> run_stability_study(const StabilityOptions& options,
                                                const StudyIdentity& identity, const StudyOptions& study,
                                                std::size_t& jobs_done,
                                                const std::function<void(double)>& progress);

}  // namespace darboux
