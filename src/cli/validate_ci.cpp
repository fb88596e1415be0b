#include <iostream>
#include <sstream>

#include <pugixml.hpp>

#include "sarif.h"
#include "validate_files.h"

namespace darboux {
namespace {

// Concerns a file, not a mesh, so it is not a finding of the library.
constexpr FindingKind lost{"FILE_NOTHING_TO_JUDGE", Severity::error,
                           "the file passed in the baseline, and there is nothing to judge now",
                           "see what became of its triangles, normals and tangents; or renew the baseline"};

// "mesh 0 primitive 0: the message (12). To do: what to do"
std::string sentence(const Primitive& primitive, const Assessment& assessment, const Finding& f) {
  return with_to_do(place_of(primitive, assessment) + ": " + f.message + " (" + std::to_string(f.count) + ")",
                    f.to_do);
}

// For a file as a whole: it cannot be read, or has nothing to judge any more.
Json result_json(const AssessedFile& file, const FindingKind& kind, const std::string& message) {
  return sarif_result(file.path, kind.code, kind.severity, kind.severity, message, "");
}

// Text that XML 1.0 permits, whatever a file contains: control characters are escaped; U+FFFE and U+FFFF
// become U+FFFD.
std::string xml_text(const std::string& text) {
  std::string result = one_line(text);
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

// "CODE (12): the message"
std::string junit_text(const Finding& f) {
  return std::string(f.code) + " (" + std::to_string(f.count) + "): " + f.message;
}

}  // namespace

Json sarif(const std::vector<AssessedFile>& files, bool with_baseline) {
  Json rules = Json::array(), results = Json::array();
  for (const FindingKind& kind : finding_kinds()) rules.push_back(sarif_rule(kind));
  for (const FindingKind& kind : {unreadable_file, lost}) rules.push_back(sarif_rule(kind));
  for (const AssessedFile& file : files) {
    const auto add_of_file = [&](const FindingKind& kind, const std::string& message) {
      results.push_back(result_json(file, kind, message));
      if (with_baseline) results.back()["baselineState"] = file.worse ? "new" : "unchanged";
    };
    if (!file.readable()) add_of_file(unreadable_file, file.error);
    if (file.lost) add_of_file(lost, with_to_do(std::string(lost.message), lost.to_do));
    for (const AssessedPrimitive& p : file.primitives)
      p.each_finding([&](const Assessment& j, const Finding& f, Severity own) {
        if (f.severity == Severity::info) return;
        results.push_back(sarif_result(file.path, f.code, f.severity, own, sentence(p.primitive, j, f),
                                       place_of(p.primitive, j)));
        if (!with_baseline) return;
        const std::size_t known = p.known_count(code_of(f), own);
        results.back()["baselineState"] = known == 0                          ? "new"
                                          : known == p.count(code_of(f), own) ? "unchanged"
                                                                              : "updated";
      });
  }
  return sarif_log(std::move(rules), std::move(results));
}

void print_github(const std::vector<AssessedFile>& files, bool with_baseline) {
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
  std::size_t printed = 0, left_out = 0, known = 0;
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
  const auto is_known = [&](const AssessedPrimitive& p, const Finding& f, Severity own) {
    if (!with_baseline) return false;
    if (f.severity == Severity::error || code_of(f) == Code::undetermined) return !p.worse(f, own);
    return p.count(code_of(f), own) <= p.known_count(code_of(f), own);
  };
  for (const Severity severity : {Severity::error, Severity::warning})
    for (const AssessedFile& file : files) {
      if (severity == Severity::error && !file.readable()) {
        if (file.worse)
          print(severity, file.path, unreadable_file.code, file.error);
        else
          ++known;
      }
      if (severity == Severity::error && file.lost)
        print(severity, file.path, lost.code, with_to_do(std::string(lost.message), lost.to_do));
      for (const AssessedPrimitive& p : file.primitives)
        p.each_finding([&](const Assessment& j, const Finding& f, Severity own) {
          if (f.severity != severity) return;
          if (is_known(p, f, own))
            ++known;
          else
            print(severity, file.path, f.code, sentence(p.primitive, j, f));
        });
    }
  if (left_out > 0) std::cout << "::notice title=darboux::" << left_out << " more findings are in the log\n";
  if (known > 0)
    std::cout << "::notice title=darboux::" << known << " findings are as in the baseline, and in the log\n";
}

std::string junit(const std::vector<AssessedFile>& files, bool with_baseline) {
  pugi::xml_document document;
  pugi::xml_node suites = document.append_child("testsuites");
  suites.append_attribute("name") = "darboux validate";
  for (const AssessedFile& file : files) {
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
    if (!file.readable() || file.primitives.empty() || file.lost) {
      pugi::xml_node test = add_case("file");
      if (file.lost)
        append(test, "failure", std::string(lost.code), with_to_do(std::string(lost.message), lost.to_do)),
            ++failures;
      else if (file.readable())
        append(test, "skipped", "nothing", "holds no triangles to judge"), ++skipped;
      else if (file.worse)
        append(test, "error", std::string(unreadable_file.code), file.error), ++errors;
      else
        append(test, "skipped", "baseline", "as in the baseline"), ++skipped;
    }
    for (const AssessedPrimitive& p : file.primitives)
      for (std::size_t a = 0; a < p.assessments.size(); ++a) {
        const Assessment& j = p.assessments[a];
        pugi::xml_node test = add_case(place_of(p.primitive, j));
        bool failed = false;
        std::string known;
        const auto fail = [&](const Finding& f) {
          append(test, "failure", std::string(f.code), with_to_do(junit_text(f), f.to_do));
          failed = true;
        };
        for (std::size_t k = 0; k < j.report.findings.size(); ++k) {
          const Finding& f = j.report.findings[k];
          if (f.severity != Severity::error) continue;
          if (!with_baseline || p.worse(f, p.own_severities[a][k]))
            fail(f);
          else
            known += (known.empty() ? "as in the baseline: " : "; ") + junit_text(f);
        }
        // The exit status counts it even if it is not an error.
        if (j.report.verdict == Verdict::undetermined && p.less_determined())
          fail(finding(Code::undetermined, 1));
        failures += failed;
        if (!known.empty()) test.append_child("system-out").text() = xml_text(known).c_str();
      }
    suite.append_attribute("tests") = tests;
    suite.append_attribute("failures") = failures;
    suite.append_attribute("errors") = errors;
    suite.append_attribute("skipped") = skipped;
  }
  std::ostringstream text;
  text.exceptions(std::ios::badbit);  // else output would be lost without memory
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

}  // namespace darboux
