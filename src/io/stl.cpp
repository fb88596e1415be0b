// STL files: their corners as points, or as a mesh.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <functional>

#include <darboux/error.h>

#include "base/text.h"
#include "mesh_files.h"
#include "points.h"

namespace darboux::io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary numbers are copied as they are");

// The content of a file in order: three corners per triangle.
struct StlParts {
  std::function<void(std::string_view name)> solid;
  std::function<void(const PointNumbers& corner, std::string_view where, std::uint64_t number)> corner;
};

void read_binary(InputBytes& bytes, std::uint32_t triangles, const StlParts& parts) {
  std::array<char, 84> head{};
  bytes.take(head.data(), head.size());
  parts.solid("");
  std::array<char, 50> record{};
  for (std::uint64_t t = 0; t < triangles && bytes.take(record.data(), 50) == 50; ++t)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::array<float, 3> p{};
      std::memcpy(p.data(), record.data() + 12 + 12 * corner, sizeof p);
      parts.corner({p[0], p[1], p[2]}, "triangle ", t);
    }
}

void read_text(InputBytes& bytes, const StlParts& parts) {
  Lines lines(bytes, "lines like vertex 0 0.5 1, three of them between outer loop and endloop");
  std::vector<std::string_view> fields;
  bool begun = false, ended = false;
  std::size_t corners = 0;
  while (lines.next()) {
    split_fields(lines.text(), ' ', fields);
    const std::string word = lower(fields[0]);
    if (!begun && word != "solid") lines.fail("a line before the first solid");
    begun = true;
    ended = word == "endsolid";
    if (word == "solid") parts.solid(trimmed(lines.text().substr(fields[0].size())));
    if ((ended || word == "endloop") && corners % 3 != 0)
      lines.fail("a triangle of " + std::to_string(corners) + " vertices");
    if (word == "endloop") corners = 0;
    if (word != "vertex") continue;
    if (fields.size() != 4) lines.fail("a vertex of " + std::to_string(fields.size() - 1) + " numbers");
    parts.corner({number_of(fields[1], lines), number_of(fields[2], lines), number_of(fields[3], lines)},
                 "line ", lines.number());
    ++corners;
  }
  if (!ended) throw FileError(bytes.path(), expected_got("a whole STL file", "one without its endsolid"));
}

// Binary files may begin with "solid" too; the file size distinguishes them.
void read_parts(InputBytes& bytes, const StlParts& parts) {
  const std::uint64_t size = bytes.size().value_or(0);
  std::array<char, 84> start{};
  std::uint32_t triangles = 0;
  std::ifstream peek(bytes.path(), std::ios::binary);
  const bool whole = static_cast<bool>(peek.read(start.data(), start.size()));
  std::memcpy(&triangles, start.data() + 80, sizeof triangles);
  if (whole && size == 84 + std::uint64_t{50} * triangles) return read_binary(bytes, triangles, parts);
  if (lower({start.data(), 5}) == "solid") return read_text(bytes, parts);
  throw FileError(
      bytes.path(),
      expected_got(
          "STL: ASCII, which begins with solid, or binary, 84 bytes and 50 for each triangle that they count",
          whole ? std::to_string(triangles) + " triangles in " + std::to_string(size) + " bytes"
                : std::string("neither")));
}

}  // namespace

PointFile read_stl_points(PointReader& reader) {
  const PointColumns columns{{0, 1, 2}, false, false};
  read_parts(reader.bytes(), {[](std::string_view) {},
                              [&](const PointNumbers& corner, std::string_view where, std::uint64_t number) {
                                reader.add(columns, corner, where, number);
                              }});
  PointFile result = reader.finish();
  find_places(result, std::vector<bool>(result.cloud.positions.size(), true));
  return result;
}

Asset read_stl(const std::string& path) {
  InputBytes bytes(path, "STL file");
  std::vector<Primitive> solids;
  read_parts(bytes, {[&](std::string_view name) {
                       solids.emplace_back().name = name;
                       solids.back().mesh = solids.size() - 1;
                       solids.back().instances = std::vector{Eigen::Matrix4d::Identity().eval()};
                     },
                     [&](const PointNumbers& corner, std::string_view, std::uint64_t) {
                       Mesh& mesh = solids.back().data;
                       if (mesh.positions.size() > UINT32_MAX - 3)
                         throw FileError(path,
                                         expected_got("at most 1431655764 triangles per solid", "more"));
                       const auto index = static_cast<std::uint32_t>(mesh.positions.size());
                       mesh.positions.push_back({corner[0], corner[1], corner[2]});
                       if (index % 3 == 2) mesh.triangles.push_back({index - 2, index - 1, index});
                     }});
  bytes.finish();
  Asset asset;
  for (Primitive& solid : solids)
    if (solid.data.triangles.empty())
      asset.skipped.push_back({solid.mesh, 0, "a solid of no facets has no triangles"});
    else
      asset.primitives.push_back(std::move(solid));
  return asset;
}

}  // namespace darboux::io
