/// \file html.h
/// What the pages for people share.
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

/// The element that lets no script run but those with these digests, in hexadecimal, and nothing be loaded.
std::string content_policy(const std::vector<std::string_view>& sha256);

/// The style of text, cards, tables and verdicts; dark where that is preferred and the root has the class
/// "both".
extern const std::string_view page_style;

}  // namespace darboux
