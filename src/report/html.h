/// \file html.h
/// Common code of the HTML pages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace darboux {

/// Text as HTML, in elements and in quoted attributes.
std::string escape(std::string_view text);

/// JSON for a <script>: nothing in it can end the element or open a comment.
std::string script_json(const nlohmann::ordered_json& json);

/// The Content-Security-Policy element that permits only scripts with these digests (hexadecimal) and loads
/// nothing.
std::string content_policy(const std::vector<std::string_view>& sha256);

/// The style of text, cards, tables and verdicts; dark if the reader prefers that and the root has the class
/// "both".
extern const std::string_view page_style;

}  // namespace darboux
