#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <pugixml.hpp>

#include "validate_files.h"

namespace darboux {
namespace {

constexpr const char* unreadable_code = "FILE_UNREADABLE";
constexpr const char* unreadable_to_do = "see what the message permits, and export the file anew";

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

Json rule_json(std::string_view code, std::string_view message, std::string_view to_do, Severity severity) {
  return {{"id", code},
          {"shortDescription", {{"text", message}}},
          {"fullDescription", {{"text", std::string(message) + ". To do: " + std::string(to_do)}}},
          {"help", {{"text", to_do}}},
          {"helpUri", std::string(DARBOUX_DOCS_URL "/findings.md#") + lower(std::string(code))},
          {"defaultConfiguration", {{"level", sarif_level(severity)}}}};
}

Json result_json(const std::string& path, std::string_view code, Severity severity,
                 const std::string& message, const std::string& place) {
  // Code scanning shows nothing without a line; the files have none that mean anything.
  Json location{
      {"physicalLocation", {{"artifactLocation", {{"uri", uri_of(path)}}}, {"region", {{"startLine", 1}}}}}};
  if (!place.empty()) location["logicalLocations"] = Json::array({{{"fullyQualifiedName", place}}});
  return {{"ruleId", code},
          {"level", sarif_level(severity)},
          {"message", {{"text", message}}},
          {"locations", Json::array({location})},
          // What stays the same when counts change.
          {"partialFingerprints", {{"primaryLocationLineHash", std::string(code) + '/' + place}}}};
}

// Without what XML 1.0 does not have, whatever a file put into it: control characters become '?', U+FFFE and
// U+FFFF U+FFFD.
std::string xml_text(const std::string& text) {
  std::string result = utf8(one_line(text));
  for (const char* none : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"})
    for (std::size_t at = 0; (at = result.find(none, at)) != std::string::npos;) result[at + 2] = '\xBD';
  return result;
}

void append(pugi::xml_node& node, const char* child, const std::string& type, const std::string& text) {
  pugi::xml_node element = node.append_child(child);
  element.append_attribute("type") = type.c_str();
  const std::string safe = xml_text(text);
  element.append_attribute("message") = safe.c_str();
  element.text() = safe.c_str();
}

}  // namespace

Json sarif(const std::vector<JudgedFile>& files, bool with_baseline) {
  Json rules = Json::array(), results = Json::array();
  for (const FindingKind& kind : finding_kinds())
    rules.push_back(rule_json(kind.code, kind.message, kind.to_do, kind.severity));
  rules.push_back(rule_json(unreadable_code, "the file cannot be read", unreadable_to_do, Severity::error));
  for (const JudgedFile& file : files) {
    if (!file.error.empty()) {
      results.push_back(result_json(file.path, unreadable_code, Severity::error, file.error, ""));
      if (with_baseline) results.back()["baselineState"] = file.worse ? "new" : "unchanged";
    }
    for (const JudgedPrimitive& p : file.primitives)
      for (const Assessment& j : p.assessments)
        for (const Finding& f : j.report.findings) {
          if (f.severity == Severity::info) continue;
          const std::string place = place_of(p.primitive, j);
          results.push_back(result_json(
              file.path, f.code, f.severity,
              place + ": " + f.message + " (" + std::to_string(f.count) + "). To do: " + std::string(f.to_do),
              place));
          if (!with_baseline) continue;
          const std::size_t known = p.known_count(f.code);
          results.back()["baselineState"] = known == 0                 ? "new"
                                            : known == p.count(f.code) ? "unchanged"
                                                                       : "updated";
        }
  }
  Json driver{{"name", "darboux"}, {"version", DARBOUX_VERSION}, {"rules", std::move(rules)}};
  Json run{{"tool", {{"driver", std::move(driver)}}}, {"results", std::move(results)}};
  return {{"$schema",
           "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"},
          {"version", "2.1.0"},
          {"runs", Json::array({std::move(run)})}};
}

void print_github(const std::vector<JudgedFile>& files) {
  constexpr std::size_t most = 50;  // GitHub shows no more
  const auto escaped = [](const std::string& text, bool property) {
    std::string result;
    for (const char c : text) {
      if (c == '%')
        result += "%25";
      else if (c == '\r')
        result += "%0D";
      else if (c == '\n')
        result += "%0A";
      else if (property && c == ':')
        result += "%3A";
      else if (property && c == ',')
        result += "%2C";
      else
        result += c;
    }
    return result;
  };
  std::size_t printed = 0, left_out = 0;
  const auto print = [&](Severity severity, const std::string& path, std::string_view title,
                         const std::string& message) {
    if (++printed > most) {
      ++left_out;
      return;
    }
    std::cout << "::" << (severity == Severity::error ? "error" : "warning")
              << " file=" << escaped(path, true) << ",title=" << title << "::" << escaped(message, false)
              << '\n';
  };
  for (const Severity severity : {Severity::error, Severity::warning})
    for (const JudgedFile& file : files) {
      if (!file.error.empty() && severity == Severity::error)
        print(severity, file.path, unreadable_code, file.error);
      for (const JudgedPrimitive& p : file.primitives)
        for (const Assessment& j : p.assessments)
          for (const Finding& f : j.report.findings)
            if (f.severity == severity)
              print(severity, file.path, f.code,
                    place_of(p.primitive, j) + ": " + f.message + " (" + std::to_string(f.count) +
                        "). To do: " + std::string(f.to_do));
    }
  if (left_out > 0) std::cout << "::notice title=darboux::" << left_out << " more findings are in the log\n";
}

std::string junit(const std::vector<JudgedFile>& files, bool with_baseline) {
  pugi::xml_document document;
  pugi::xml_node suites = document.append_child("testsuites");
  suites.append_attribute("name") = "darboux validate";
  for (const JudgedFile& file : files) {
    std::size_t tests = 0, failures = 0, errors = 0, skipped = 0;
    pugi::xml_node suite = suites.append_child("testsuite");
    const std::string path = xml_text(file.path);
    suite.append_attribute("name") = path.c_str();
    const auto add_case = [&](const std::string& name) {
      ++tests;
      pugi::xml_node test = suite.append_child("testcase");
      test.append_attribute("classname") = path.c_str();
      test.append_attribute("name") = xml_text(name).c_str();
      test.append_attribute("file") = path.c_str();
      return test;
    };
    if (!file.error.empty() || file.primitives.empty()) {
      pugi::xml_node test = add_case("file");
      if (!file.worse)
        append(test, "skipped", "baseline", "as in the baseline"), ++skipped;
      else if (file.error.empty())
        append(test, "failure", "undetermined", "holds no triangles to judge"), ++failures;
      else
        append(test, "error", unreadable_code, file.error), ++errors;
    }
    for (const JudgedPrimitive& p : file.primitives)
      for (const Assessment& j : p.assessments) {
        pugi::xml_node test = add_case(place_of(p.primitive, j));
        bool failed = false;
        std::string known;
        for (const Finding& f : j.report.findings) {
          if (f.severity != Severity::error) continue;
          const std::string text = std::string(f.code) + " (" + std::to_string(f.count) + "): " + f.message;
          if (with_baseline && !p.worse(f)) {
            known += (known.empty() ? "as in the baseline: " : "; ") + text;
            continue;
          }
          append(test, "failure", std::string(f.code), text + ". To do: " + std::string(f.to_do));
          failed = true;
        }
        if (j.report.verdict == Verdict::undetermined && p.less_determined()) {
          append(test, "failure", "undetermined", "nothing or too little is known to compare with");
          failed = true;
        }
        failures += failed;
        if (!known.empty()) test.append_child("system-out").text() = xml_text(known).c_str();
      }
    suite.append_attribute("tests") = tests;
    suite.append_attribute("failures") = failures;
    suite.append_attribute("errors") = errors;
    suite.append_attribute("skipped") = skipped;
  }
  std::ostringstream text;
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

}  // namespace darboux
