/// \file cli.h
/// What the tests of the command line share: the tool, run through a shell in a folder of its own that holds
/// `data`, and readers of what it prints.
#pragma once

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <darboux/any_surface.h>

#include "io_files.h"

namespace darboux::test {

namespace fs = std::filesystem;

struct Result {
  int status;
  std::string out, err;
};

class Cli : public ::testing::Test {
 protected:
  Cli() {
    fs::create_directory(folder_ / "work");
    fs::create_directory_symlink(DARBOUX_TEST_DATA, folder_ / "work/data");
    fs::create_directory(folder_ / "bin");
    fs::create_symlink(DARBOUX_TOOL, folder_ / "bin/darboux");
  }

  // Runs a shell command, in which `darboux` is the tool.
  Result sh(const std::string& command) const {
    const std::string script = "cd '" + path("") + "' && export PATH='" + (folder_ / "bin") +
                               "':\"$PATH\" && { " + command + "\n} >'" + (folder_ / "out") + "' 2>'" +
                               (folder_ / "err") + "' </dev/null";
    const int status = std::system(script.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(folder_ / "out"),
            read_bytes(folder_ / "err")};
  }

  // Runs a command that must end with this status, without a word on stderr.
  std::string good(const std::string& command, int status = 0) const {
    const Result r = sh(command);
    EXPECT_EQ(r.status, status) << command << '\n' << r.out << r.err;
    EXPECT_EQ(r.err, "") << command;
    return r.out;
  }

  // The same for a command whose whole stdout is one JSON document.
  Json json(const std::string& command, int status = 0) const {
    const std::string out = good(command, status);
    const Json result = Json::parse(out, nullptr, false);
    EXPECT_FALSE(result.is_discarded()) << command << '\n' << out;
    return result;
  }

  // Runs a command that must be refused: status 2, one line on stderr that begins with "darboux: " and holds
  // all of `parts`, nothing on stdout.
  void refused(const std::string& command, const std::vector<std::string>& parts = {}) const {
    SCOPED_TRACE(command);
    const Result r = sh(command);
    EXPECT_EQ(r.status, 2);
    EXPECT_EQ(r.out, "");
    expect_one_line(r.err);
    for (const std::string& part : parts)
      EXPECT_NE(r.err.find(part), std::string::npos) << part << " in " << r.err;
  }
  static void expect_one_line(const std::string& err) {
    EXPECT_EQ(err.rfind("darboux: ", 0), 0u) << err;
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_EQ(err.back(), '\n');
  }

  std::string path(const std::string& name) const { return folder_ / ("work/" + name); }

  // The names of the subcommands, from the tool's own help.
  std::vector<std::string> subcommands() const {
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

 private:
  TempFolder folder_;
};

inline std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> result;
  for (const auto& [key, value] : object.items()) result.push_back(key);
  return result;
}

// Every key is there; more may be.
inline void expect_keys(const Json& object, const std::vector<std::string>& wanted) {
  for (const std::string& key : wanted) EXPECT_TRUE(object.contains(key)) << key << " in " << object.dump();
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

inline std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line)
    if (c == ',')
      result.emplace_back();
    else
      result.back() += c;
  return result;
}

inline double to_double(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc{} && end == text.data() + text.size()) << text;
  return value;
}

// The one assessed primitive of a file.
inline Json only_mesh(const Json& document) {
  EXPECT_EQ(document["files"].size(), 1u);
  EXPECT_EQ(document["files"][0]["meshes"].size(), 1u) << document;
  return document["files"][0]["meshes"][0];
}

inline bool has_finding(const Json& mesh, const std::string& code) {
  for (const Json& f : mesh["findings"])
    if (f["code"] == code) return true;
  return false;
}

}  // namespace darboux::test
