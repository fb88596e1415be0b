// docs/findings.md has a section for each code, which says what the tool says.
#include <cctype>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <darboux/validate.h>

namespace darboux::findings_page_test {
namespace {

// With single spaces for what separates words.
std::string words(const std::string& text) {
  std::istringstream in(text);
  std::string result;
  for (std::string word; in >> word;) result += (result.empty() ? "" : " ") + word;
  return result;
}

TEST(FindingsPage, HasASectionForEachCode) {
  std::ifstream in(DARBOUX_SOURCE "/docs/findings.md");
  ASSERT_TRUE(in);
  std::map<std::string, std::string> sections;
  std::string code;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("## "))
      code = line.substr(3), sections[code];
    else if (!code.empty())
      sections[code] += line + '\n';
  for (const char* of_others : {"FILE_UNREADABLE", "FILE_NOTHING_TO_JUDGE", "TANGENT_NEEDED", "TANGENT_IDLE",
                                "TANGENT_DROPPED"})  // of files, and of `plan`
    EXPECT_EQ(sections.erase(of_others), 1u) << of_others;
  for (const FindingKind& kind : finding_kinds()) {
    ASSERT_TRUE(sections.contains(std::string(kind.code))) << kind.code;
    std::string severity(severity_names[static_cast<std::size_t>(kind.severity)]);
    severity.front() = static_cast<char>(std::toupper(severity.front()));
    const std::string section = words(sections[std::string(kind.code)]);
    EXPECT_TRUE(section.starts_with(severity + ": " + words(std::string(kind.message)) + ".")) << section;
    EXPECT_TRUE(section.ends_with("To do: " + words(std::string(kind.to_do)) + ".")) << section;
  }
  EXPECT_EQ(sections.size(), finding_kinds().size());
}

}  // namespace
}  // namespace darboux::findings_page_test
