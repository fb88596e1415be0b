#include "contest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <sched.h>
#include <sys/wait.h>

#include "measure.h"
#include "torus_file.h"

namespace darboux::bench {
namespace {

// Seconds: a maker that takes longer for a call is measured once, one whose process takes longer not at all.
constexpr double longest_call = 20;
constexpr int longest_process = 90;

// What a command prints; where it fails, `refusal` is its last line, or else how it ended.
std::string output_of(const std::string& command, std::string& refusal) {
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
  std::string output;
  for (std::array<char, 256> piece{}; std::fgets(piece.data(), piece.size(), pipe) != nullptr;)
    output += piece.data();
  const int status = pclose(pipe);
  if (status == 0) return output;
  constexpr int timed_out = 124;  // of timeout
  if (WEXITSTATUS(status) == timed_out) {
    refusal = "takes more than " + std::to_string(longest_process) + " seconds";
    return output;
  }
  refusal = "ended with status " + std::to_string(WEXITSTATUS(status));
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) refusal = line;
  return output;
}

std::optional<Sample> measure(const Maker& maker, const std::filesystem::path& mesh,
                              const std::filesystem::path& tangents, std::string& refusal) {
  refusal = maker.missing;
  const std::vector<int> cores = allowed_cores();
  if (static_cast<std::size_t>(maker.threads) > cores.size()) refusal = "there are too few cores";
  if (!refusal.empty()) return {};
  std::ostringstream command;
  command << "timeout " << longest_process << " taskset -c ";
  for (int k = 0; k < maker.threads; ++k) command << (k > 0 ? "," : "") << cores[static_cast<std::size_t>(k)];
  command << ' ' << maker.command << ' ' << mesh;
  if (!tangents.empty()) command << ' ' << tangents / maker.key;
  std::istringstream output(output_of(command.str(), refusal));
  if (!refusal.empty()) return {};
  Sample result{};
  if (!(output >> result.seconds >> result.first_seconds >> result.bytes))
    throw std::runtime_error(maker.name + ": no numbers");
  return result;
}

}  // namespace

double Result::seconds() const {
  std::vector<double> all;
  for (const Sample& x : samples) all.push_back(x.seconds);
  return median(all);
}
double Result::first_seconds() const {
  std::vector<double> all;
  for (const Sample& x : samples) all.push_back(x.first_seconds);
  return median(all);
}
double Result::bytes() const {
  double most = std::numeric_limits<double>::quiet_NaN();
  for (const Sample& x : samples) most = std::fmax(most, x.bytes);
  return most;
}
double Result::ratio() const {
  return over.empty() && !samples.empty() ? 1 : median(over);
}

std::vector<int> allowed_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0)
    throw std::runtime_error("the system does not tell which cores may be used");
  std::vector<int> cores;
  for (int k = 0; k < CPU_SETSIZE; ++k)
    if (CPU_ISSET(k, &set)) cores.push_back(k);
  return cores;
}

void allow_cores(const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int k : cores) CPU_SET(k, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) throw std::runtime_error("these cores may not be used");
}

std::vector<Result> Contest::pairs(const std::filesystem::path& mesh, int rounds,
                                   const std::filesystem::path& tangents) const {
  std::vector<Result> results(makers_.size());
  Result& first = results.front();
  for (std::size_t k = 1; k < makers_.size(); ++k) {
    std::cerr << mesh.filename().string() << ": " << makers_[k].name << " ...\n";
    Result& other = results[k];
    for (int round = 0; round < rounds; ++round) {
      const std::optional<Sample> before = measure(makers_.front(), mesh, tangents, first.refusal);
      if (!before) throw std::runtime_error(makers_.front().name + ": " + first.refusal);
      first.samples.push_back(*before);
      const std::optional<Sample> after = measure(makers_[k], mesh, tangents, other.refusal);
      if (!after) break;
      other.samples.push_back(*after);
      other.over.push_back(after->seconds / before->seconds);
      if (after->seconds > longest_call) break;
    }
  }
  return results;
}

void Contest::run(const std::filesystem::path& folder, int rounds, const std::string& compared_at) {
  for (const Size& size : sizes_) {
    const std::filesystem::path file = folder / (size.name + (indexed_ ? "-indexed" : ""));
    const bool compare = size.name == compared_at;
    MeshArrays mesh = torus(size.columns, size.rows);
    if (!indexed_) mesh = unindexed(mesh);
    write(mesh, file);
    if (!compare) mesh = {};  // its memory is for the makers
    results_.push_back(pairs(file, rounds, compare ? folder : ""));
    std::filesystem::remove(file);
    if (!compare) continue;
    const std::vector<float> ours = read_floats(folder / makers_.front().key);
    for (std::size_t k = 0; k < makers_.size(); ++k)
      if (!results_.back()[k].samples.empty())
        differences_[k] = difference(ours, read_floats(folder / makers_[k].key), mesh);
  }
}

const Difference* Contest::compared(std::size_t maker) const {
  const auto at = differences_.find(maker);
  return at == differences_.end() ? nullptr : &at->second;
}

}  // namespace darboux::bench
