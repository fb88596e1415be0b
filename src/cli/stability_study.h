/// \file stability_study.h
/// The study of `darboux stability`: study file, presets, jobs.
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

/// The settings of `stability` as texts, in the notation of its options: the content of a study file. Empty:
/// all.
struct StabilityChoices {
  std::vector<std::string> surfaces, sweeps, routes;
  int points = 24, samples = 3;
  std::uint64_t seed = 1;
};

inline constexpr int most_points = 10000;  ///< of a sweep, and samples at each

/// The settings of a preset. quick: the defaults; standard: 61 values of x, 8 samples; full: 301, 16. Empty
/// for an unknown name.
std::optional<StabilityChoices> stability_preset(std::string_view name);

/// Overrides `choices` by the settings in a study file (docs/schemas/stability-study.schema.json). \throws
/// FileError with the path of the invalid key
void read_stability_study(const std::string& file, StabilityChoices& choices);

/// Everything on which the results depend: all settings.
Json stability_identity(const StabilityOptions& options);

/// Runs or resumes the jobs of a shard. The curves are complete if the shard is 1/1. \param jobs_done
/// receives the number of jobs of the shard with results
std::vector<StabilityCurve> run_stability_study(const StabilityOptions& options,
                                                const StudyIdentity& identity, const StudyOptions& study,
                                                std::size_t& jobs_done,
                                                const std::function<void(double)>& progress);

}  // namespace darboux
