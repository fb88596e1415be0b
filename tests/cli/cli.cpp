#include "cli.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <sstream>

#include <sys/wait.h>

namespace darboux::test {

Cli::Cli() {
  fs::create_directory(folder_ / "work");
  fs::create_directory_symlink(DARBOUX_TEST_DATA, folder_ / "work/data");
  fs::create_directory(folder_ / "bin");
  fs::create_symlink(DARBOUX_TOOL, folder_ / "bin/darboux");
}

Result Cli::sh(const std::string& command) const {
  const std::string script = "cd '" + path("") + "' && export PATH='" + (folder_ / "bin") +
                             "':\"$PATH\" && { " + command + "\n} >'" + (folder_ / "out") + "' 2>'" +
                             (folder_ / "err") + "' </dev/null";
  const int status = std::system(script.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(folder_ / "out"),
          read_bytes(folder_ / "err")};
}

std::string Cli::good(const std::string& command, int status) const {
  const Result r = sh(command);
  EXPECT_EQ(r.status, status) << command << '\n' << r.out << r.err;
  EXPECT_EQ(r.err, "") << command;
  return r.out;
}

Json Cli::json(const std::string& command, int status) const {
  const std::string out = good(command, status);
  const Json result = Json::parse(out, nullptr, false);
  EXPECT_FALSE(result.is_discarded()) << command << '\n' << out;
  return result;
}

Json Cli::written_in_all_formats(const std::string& run, const std::string& heading) const {
  good(run + "-o page.html");
  good(run + "-o picture.svg");
  good(run + "-o tables.md");
  good(run + "-o same --format json");
  EXPECT_NE(read_bytes(path("page.html")).find("<!DOCTYPE html>"), std::string::npos);
  EXPECT_NE(read_bytes(path("picture.svg")).find("</svg>"), std::string::npos);
  EXPECT_NE(read_bytes(path("tables.md")).find(heading), std::string::npos);
  return Json::parse(read_bytes(path("same")));
}

void Cli::refused(const std::string& command, const std::vector<std::string>& parts) const {
  SCOPED_TRACE(command);
  const Result r = sh(command);
  EXPECT_EQ(r.status, 2);
  EXPECT_EQ(r.out, "");
  expect_one_line(r.err);
  for (const std::string& part : parts)
    EXPECT_NE(r.err.find(part), std::string::npos) << part << " in " << r.err;
}

void Cli::expect_one_line(const std::string& err) {
  EXPECT_EQ(err.rfind("darboux: ", 0), 0u) << err;
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  EXPECT_EQ(err.back(), '\n');
}

std::vector<std::string> Cli::subcommands() const {
  std::istringstream help(good("darboux --help"));
  std::vector<std::string> names;
  bool list = false;
  for (std::string line; std::getline(help, line);) {
    if (line == "Subcommands:")
      list = true;
    else if (line.empty())
      list = false;
    else if (list && line[2] != ' ')
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> result;
  for (const auto& [key, value] : object.items()) result.push_back(key);
  return result;
}

void expect_keys(const Json& object, const std::vector<std::string>& wanted) {
  for (const std::string& key : wanted) EXPECT_TRUE(object.contains(key)) << key << " in " << object.dump();
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line)
    if (c == ',')
      result.emplace_back();
    else
      result.back() += c;
  return result;
}

double to_double(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc{} && end == text.data() + text.size()) << text;
  return value;
}

Json only_mesh(const Json& document) {
  EXPECT_EQ(document["files"].size(), 1u);
  EXPECT_EQ(document["files"][0]["meshes"].size(), 1u) << document;
  return document["files"][0]["meshes"][0];
}

bool has_finding(const Json& mesh, const std::string& code) {
  for (const Json& f : mesh["findings"])
    if (f["code"] == code) return true;
  return false;
}

}  // namespace darboux::test
