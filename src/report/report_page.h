/// \file report_page.h
/// The page that all report commands write: one file that needs no network.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "provenance.h"

namespace darboux {

struct ReportPage {
  std::string title;     ///< of the window
  std::string question;  ///< what the page answers
  std::string lead;      ///< HTML: what is measured, for who sees it for the first time
  std::string answer;    ///< one sentence
  std::string body;      ///< HTML: sections
  nlohmann::ordered_json data;
  std::string_view script, script_sha256;  ///< what draws them: it finds `kit` of page_kit.js
};

/// Question, answer, sections, provenance of the numbers. Only the page's own scripts run, whatever the data
/// contain.
std::string report_page(const ReportPage& page, const Provenance& provenance);

/// The elements that the script fills: a picture, and its controls. All texts are HTML.
/// \param id of the canvas
std::string picture_html(std::string_view id, std::string_view caption);

}  // namespace darboux
