/// \file stability_report.h
/// The curves of `darboux stability` as JSON, CSV and text.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/stability.h>

namespace darboux {

/// The curves as `darboux stability --json` prints them; an error without end, a bound that is not stated are
/// null.
nlohmann::ordered_json curves_json(const std::vector<StabilityCurve>& curves);
/// The same back. \throws nlohmann::json::exception, ParameterError for another document
StabilityCurve curve_of(const nlohmann::ordered_json& json);

/// One row per point of a curve, with a header.
std::string curves_csv(const std::vector<StabilityCurve>& curves);

/// For a terminal: a line per surface and sweep with the point where Darboux's double comes nearest to its
/// bound and how the naive formulas fare, then every curve that leaves its bound, then a sentence.
std::string stability_text(const std::vector<StabilityCurve>& curves);

/// "312 curves with a bound, all within it; the naive formulas lose all digits in 41 of 120"
std::string stability_summary(const std::vector<StabilityCurve>& curves);

}  // namespace darboux
