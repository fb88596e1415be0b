/// \file stability_report.h
/// The curves of `darboux stability` as JSON, CSV and text.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/stability.h>

#include "provenance.h"

namespace darboux {

/// The curves as printed by `darboux stability --json`; infinite errors and missing bounds are null.
nlohmann::ordered_json curves_json(const std::vector<StabilityCurve>& curves);
/// Reads a curve from that JSON. \throws nlohmann::json::exception, ParameterError for another document
StabilityCurve curve_of(const nlohmann::ordered_json& json);

/// One row per point of a curve, with a header.
std::string curves_csv(const std::vector<StabilityCurve>& curves);

/// The largest error of a curve in roundings, over the points with a bound; over all points if there is none.
double largest_error(const StabilityCurve& curve);

/// Whether a bound is stated anywhere on the curve.
bool has_bound(const StabilityCurve& curve);

/// The share of a bound as text: "29 %"; "no bound" if none is stated: `factor` is negative.
std::string share_text(double factor);

/// Whether a curve counts in overviews: Darboux in double; every method over meshes, every fit.
bool leads(const StabilityCurve& curve);

/// Text for a terminal: one line per surface and sweep, with the point where Darboux in double is nearest to
/// its bound and the error of the naive formulas; then every curve that exceeds its bound; then a summary.
std::string stability_text(const std::vector<StabilityCurve>& curves);

/// The same as Markdown, for docs: a table of surfaces by sweeps with the largest error and the largest share
/// of its bound, and one of the errors of the naive formulas.
std::string stability_markdown(const std::vector<StabilityCurve>& curves, const Provenance& provenance);

/// A self-contained HTML page: surfaces by sweeps as a table of colours, the curves of the one chosen as a
/// picture, everything beyond its bound as a list. Works offline; without scripts the tables are still shown.
std::string stability_page(const std::vector<StabilityCurve>& curves, const Provenance& provenance);

/// A picture: the curves of the first surface, a panel per sweep of evaluation, a line per route, of the
/// quantity in which the naive formulas lose most.
std::string stability_picture(const std::vector<StabilityCurve>& curves);

/// "312 curves with a bound, all within it; the naive formulas leave Darboux's bound in 41 of 120"
std::string stability_summary(const std::vector<StabilityCurve>& curves);

}  // namespace darboux
