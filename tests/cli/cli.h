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
  Cli();

  // Runs a shell command, in which `darboux` is the tool.
  Result sh(const std::string& command) const;

  // Runs a command that must end with this status, without a word on stderr.
  std::string good(const std::string& command, int status = 0) const;

  // The same for a command whose whole stdout is one JSON document.
  Json json(const std::string& command, int status = 0) const;

  // Runs a report command into a page, a picture, tables that hold `heading`, and JSON. \returns the last
  Json written_in_all_formats(const std::string& run, const std::string& heading) const;

  // Runs a command that must be refused: status 2, one line on stderr that begins with "darboux: " and holds
  // all of `parts`, nothing on stdout.
  void refused(const std::string& command, const std::vector<std::string>& parts = {}) const;
  static void expect_one_line(const std::string& err);

  std::string path(const std::string& name) const { return folder_ / ("work/" + name); }

  // The names of the subcommands, from the tool's own help.
  std::vector<std::string> subcommands() const;

 private:
  TempFolder folder_;
};

std::vector<std::string> keys(const Json& object);

// Every key is there; more may be.
void expect_keys(const Json& object, const std::vector<std::string>& wanted);

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::vector<std::string> lines(const std::string& text);
std::vector<std::string> fields(const std::string& line);
double to_double(const std::string& text);

// The one assessed primitive of a file.
Json only_mesh(const Json& document);
bool has_finding(const Json& mesh, const std::string& code);

}  // namespace darboux::test
