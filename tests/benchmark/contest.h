/// \file contest.h
/// Makers of tangents against one of them, in turns.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "difference.h"
#include "tangent_makers.h"

namespace darboux::bench {

/// A torus by its number of triangles.
struct Size {
  std::string name;
  int columns, rows;

  double triangles() const { return 2.0 * columns * rows; }
};

/// A maker, and the command that measures it.
struct Maker {
  std::string name;     ///< as written in tables
  std::string key;      ///< the file that it writes its tangents to
  std::string command;  ///< takes the files of mesh and tangents, prints the numbers of a Sample
  int threads = 1;
  std::string missing{};  ///< why it cannot be had; empty: it can
};

/// What was measured of a maker on one mesh.
struct Result {
  std::vector<Sample> samples{};  ///< of each round; of the maker that all are against, of each pair
  std::vector<double>
      over{};             ///< of each round: its time over that of the one that all are against, just before
  std::string refusal{};  ///< why there are none

  double seconds() const;        ///< median; NaN where there are none
  double first_seconds() const;  ///< median
  double bytes() const;          ///< the most
  double ratio() const;          ///< median of `over`; 1 of the one that all are against
};

/// Makers on tori of several sizes, all against the first: for each of the others so many pairs, the first
/// and then the other, each in a process of its own, on as many cores as it has threads. A maker that fails
/// on a mesh, or takes more than 90 seconds, is not run on it again, nor one whose call takes more than 20.
class Contest {
 public:
  Contest(std::vector<Maker> makers, std::vector<Size> sizes, bool indexed)
      : makers_(std::move(makers)), sizes_(std::move(sizes)), indexed_(indexed) {}

  /// \param folder where the meshes go while they are needed, and the tangents that are compared
  /// \param compared_at the size at which tangents are compared
  /// \throws std::runtime_error where the first maker fails
  void run(const std::filesystem::path& folder, int rounds, const std::string& compared_at);

  const std::vector<Maker>& makers() const { return makers_; }
  const std::vector<Size>& sizes() const { return sizes_; }
  const Result& result(std::size_t maker, std::size_t size) const { return results_[size][maker]; }
  /// From the first maker's tangents; null where there are none to compare.
  const Difference* compared(std::size_t maker) const;

 private:
  std::vector<Result> pairs(const std::filesystem::path& mesh, int rounds,
                            const std::filesystem::path& tangents) const;

  std::vector<Maker> makers_;
  std::vector<Size> sizes_;
  bool indexed_;
  std::vector<std::vector<Result>> results_;  // of each size, of each maker
  std::map<std::size_t, Difference> differences_;
};

/// The cores that this process may run on.
std::vector<int> allowed_cores();
/// Those that this thread, and threads and processes that it starts from now on, run on.
void allow_cores(const std::vector<int>& cores);

}  // namespace darboux::bench
