/// \file tools.h
/// What the tables of docs/reports/tools.md share.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace darboux::bench {

/// A line of a file of figures that were measured earlier, by the names of its columns.
using Line = std::map<std::string, std::string>;
/// \throws std::runtime_error
std::vector<Line> read_figures(const std::filesystem::path& file);

/// Whether a value, rounded to the digits that a figure is written with, is that figure.
bool reproduces(const std::string& figure, double value);

/// That many significant digits, zeros at the end too.
std::string significant(double x, int digits);

/// What became of figures of one kind.
struct Tally {
  int met = 0, missed = 0;
};

/// The table of Khronos's sample models in a folder, and of its figures beside those measured earlier.
void sample_models(const std::filesystem::path& folder, const std::vector<Line>& earlier, Tally& tally,
                   std::ostream& out);

/// Rows of a table: what tools/make.mjs wrote for resolution n, and assimp's tangents of it, beside the files
/// NAME_N.TOOL.glb of a folder, corner by corner.
void beside_kept(const std::filesystem::path& work, int n, const std::filesystem::path& folder,
                 std::ostream& out);

}  // namespace darboux::bench
