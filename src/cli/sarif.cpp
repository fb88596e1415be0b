#include "sarif.h"

#include <array>
#include <filesystem>

namespace darboux {
namespace {

std::string_view sarif_level(Severity severity) {
  constexpr std::array<std::string_view, severity_names.size()> names{"note", "warning", "error"};
  return names[static_cast<std::size_t>(severity)];
}

// A path as a URI reference, RFC 3986.
std::string uri_of(const std::string& path) {
  const std::filesystem::path normal = std::filesystem::path(path).lexically_normal();
  std::string uri = normal.is_absolute() ? "file://" : "";
  for (const char c : normal.generic_string()) {
    constexpr std::string_view hexadecimal = "0123456789ABCDEF", plain = "-._~/";
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || plain.find(c) != std::string_view::npos)
      uri += c;
    else
      uri.append({'%', hexadecimal[byte >> 4], hexadecimal[byte & 15]});
  }
  return uri;
}

}  // namespace

std::string with_to_do(const std::string& message, std::string_view to_do) {
  return message + ". To do: " + std::string(to_do);
}

Json sarif_rule(const FindingKind& kind) {
  Json rule{{"id", kind.code},
            {"shortDescription", {{"text", kind.message}}},
            {"fullDescription", {{"text", with_to_do(std::string(kind.message), kind.to_do)}}},
            {"help", {{"text", kind.to_do}}},
            {"defaultConfiguration", {{"level", sarif_level(kind.severity)}}}};
  // The path of a locally installed page is useless where the report is read.
  constexpr std::string_view docs = DARBOUX_DOCS_URL;
  if (docs.starts_with("http://") || docs.starts_with("https://"))
    rule["helpUri"] = std::string(docs) + "/findings.md#" + lower(std::string(kind.code));
  return rule;
}

Json sarif_result(const std::string& path, std::string_view code, Severity severity, Severity own,
                  const std::string& message, const std::string& place) {
  // Code scanning needs a line to show a result; in these files no line is meaningful.
  Json location{
      {"physicalLocation", {{"artifactLocation", {{"uri", uri_of(path)}}}, {"region", {{"startLine", 1}}}}}};
  if (!place.empty()) location["logicalLocations"] = Json::array({{{"fullyQualifiedName", place}}});
  // Independent of counts and options.
  const std::string fingerprint = std::string(code) + '/' + place + '/' + std::string(sarif_level(own));
  return {{"ruleId", code},
          {"level", sarif_level(severity)},
          {"message", {{"text", message}}},
          {"locations", Json::array({location})},
          {"partialFingerprints", {{"primaryLocationLineHash", fingerprint}}}};
}

Json sarif_log(Json rules, Json results) {
  Json driver{{"name", "darboux"}, {"version", DARBOUX_VERSION}, {"rules", std::move(rules)}};
  Json run{{"tool", {{"driver", std::move(driver)}}}, {"results", std::move(results)}};
  return {{"$schema",
           "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"},
          {"version", "2.1.0"},
          {"runs", Json::array({std::move(run)})}};
}

}  // namespace darboux
