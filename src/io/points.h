/// \file points.h
/// Collects points from a file into a cloud.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/io.h>

#include "input.h"

namespace darboux::io {

/// The numbers of a point: x y z, nx ny nz, u v.
using PointNumbers = std::array<double, 8>;

/// The content of a file's columns.
struct PointColumns {
  std::vector<int> slots;  ///< for each column its index in PointNumbers, or -1
  bool normals = false, uvs = false;

  /// Determines the columns from their names. \throws FileError with the subject `where` if x, y or z is
  /// missing, or a name occurs twice
  static PointColumns named(std::span<const std::string> names, const std::string& where);
};

/// An open file and the points read from it so far.
class PointReader {
 public:
  /// \param kind the expected kind of file, "PLY file" \throws FileError if it is not a readable regular file
  PointReader(const std::string& path, const std::string& kind, const std::function<void(double)>& progress);

  InputBytes& bytes() { return bytes_; }
  const std::string& path() const { return bytes_.path(); }
  /// \param where its location: "line " or "vertex ", and the number
  void add(const PointColumns& columns, const PointNumbers& point, std::string_view where,
           std::uint64_t number);
  /// Returns the points. \throws FileError if reading ended because of an error, or if there are no points
  PointFile finish();

 private:
  InputBytes bytes_;
  const std::function<void(double)>& progress_;
  PointFile result_;
};

/// Parses a number of a line. \throws FileError with file and line if it is not a number
double number_of(std::string_view field, const Lines& lines);

/// Fills in PointFile::place. \param used by a triangle
void find_places(PointFile& file, const std::vector<bool>& used);

// Whether files of points have this extension, in lower case, with the dot.
bool is_of_points(std::string_view extension);

// One function per family of formats.
PointFile read_table(PointReader& reader);
PointFile read_obj_points(PointReader& reader);
PointFile read_stl_points(PointReader& reader);
PointFile read_ply_points(PointReader& reader);
PointFile read_pcd_points(PointReader& reader);

}  // namespace darboux::io
