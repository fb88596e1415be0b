/// \file converge_report.h
/// The results of `darboux converge` as JSON, CSV and an HTML page.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/converge.h>

#include "provenance.h"

namespace darboux {

/// The studies as `darboux converge --json` prints them; numbers that do not exist are null.
nlohmann::ordered_json studies_json(const std::vector<Study>& studies);

/// One row per study and resolution, with a header; RFC 4180 quoting, numbers read back to the same bits, an
/// order that does not exist is an empty field.
std::string studies_csv(const std::vector<Study>& studies);

/// "405 studies: 269 as expected, 3 faster, 91 at the floor, 42 without convergence, where none is expected".
std::string verdict_summary(const std::vector<Study>& studies);

/// Orders of the tangents for a terminal: a block per surface and mesh, a row per method, a column per class.
std::string orders_text(const std::vector<Study>& studies);
/// The same as Markdown, with errors and run times of each resolution, followed by unexpected orders.
std::string converge_markdown(const std::vector<Study>& studies, const Provenance& provenance);
/// The orders that are not as expected: "slower: torus, jittered mesh, ...", one line each.
std::vector<std::string> unexpected(const std::vector<Study>& studies);

/// A self-contained HTML page: error against mesh width and against run time as pictures, all studies as a
/// map and a table. Works offline; without scripts the orders of the tangents are still shown.
std::string converge_page(const std::vector<Study>& studies, const Provenance& provenance);

}  // namespace darboux
