// Polygons of a COLLADA document.
#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <darboux/error.h>

#include "collada.h"
#include "mesh_files.h"

namespace darboux::io {
namespace {

// Vectors of a <source>: a number of components each, selected from an array.
struct Source {
  const std::vector<double>* values = nullptr;
  std::uint64_t offset = 0, stride = 1, count = 0;
  std::vector<std::size_t> places;  // of the components, from where a vector begins

  double component(std::uint64_t index, std::size_t k) const {
    return (*values)[offset + index * stride + places[k]];
  }
};

struct Input {
  std::uint64_t offset;  // of its index among those of a corner
  Source source;
};

// The inputs of a corner.
struct Inputs {
  std::optional<Input> position, normal, tangent, bitangent;
  std::map<std::uint64_t, Input> uvs;  // by set
  std::uint64_t stride = 1;            // indices of a corner
};

class GeometryReader {
 public:
  GeometryReader(const Collada& file, Budget& budget) : file_(file), budget_(budget) {}

  void read(const pugi::xml_node& group, Primitive& primitive) {
    const Inputs inputs = read_inputs(group);
    const std::vector<std::vector<std::uint64_t>> polygons = read_polygons(group, inputs);
    Mesh& mesh = primitive.data;
    const bool tangents = inputs.normal && inputs.tangent && inputs.bitangent;
    if (tangents)
      for (auto set = inputs.uvs.begin(); set != inputs.uvs.end(); ++set)
        if (set != inputs.uvs.begin())
          primitive.other_uvs.emplace_back(static_cast<int>(set->first), std::vector<Vec2<double>>{});
    if (!inputs.uvs.empty()) primitive.texcoord = static_cast<int>(inputs.uvs.begin()->first);
    for (const std::vector<std::uint64_t>& polygon : polygons) {
      const std::size_t corners = polygon.size() / inputs.stride;
      if (corners < 3) continue;
      if (mesh.positions.size() + corners > UINT32_MAX)
        file_.fail(group, "at most 4294967295 corners", "more");
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t k = 1; k + 1 < corners; ++k)
        mesh.triangles.push_back({first, first + k, first + k + 1});
      for (std::size_t k = 0; k < corners; ++k)
        add_corner(group, inputs, polygon.data() + k * inputs.stride, tangents, primitive);
    }
  }

 private:
  Source read_source(const pugi::xml_node& source, std::size_t components) {
    const pugi::xml_node accessor = source.child("technique_common").child("accessor");
    if (!accessor) file_.fail(source, "an accessor in its technique_common", "none");
    Source result;
    const std::vector<double>& values = file_.array(file_.target(accessor, "source", "float_array"));
    result.values = &values;
    result.offset = file_.count(accessor, "offset", 0);
    result.stride = file_.count(accessor, "stride", 1);
    result.count = file_.count(accessor, "count", 0);
    std::size_t place = 0;
    for (const pugi::xml_node param : accessor.children("param")) {
      if (param.attribute("name")) result.places.push_back(place);
      ++place;
    }
    if (result.places.empty())
      for (std::size_t k = 0; k < std::min<std::uint64_t>(result.stride, components); ++k)
        result.places.push_back(k);
    if (result.places.size() < components)
      file_.fail(accessor, "at least " + std::to_string(components) + " components",
                 std::to_string(result.places.size()));
    result.places.resize(components);
    const std::uint64_t width = result.places.back() + 1, there = values.size();
    if (result.count > 0 &&
        (result.stride < width || result.offset > there || width > there - result.offset ||
         result.count - 1 > (there - result.offset - width) / result.stride))
      file_.fail(accessor, "vectors within the " + std::to_string(there) + " numbers of its array",
                 std::to_string(result.count) + " vectors of " + std::to_string(width) + " numbers, " +
                     std::to_string(result.stride) + " apart");
    return result;
  }

  void add_input(const pugi::xml_node& input, std::uint64_t offset, Inputs& inputs) {
    const std::string_view semantic = input.attribute("semantic").value();
    const auto add = [&](std::optional<Input>& into, std::size_t components) {
      if (!into) into = Input{offset, read_source(file_.target(input, "source", "source"), components)};
    };
    if (semantic == "POSITION") add(inputs.position, 3);
    if (semantic == "NORMAL") add(inputs.normal, 3);
    if (semantic == "TEXTANGENT" || semantic == "TANGENT") add(inputs.tangent, 3);
    if (semantic == "TEXBINORMAL" || semantic == "BINORMAL") add(inputs.bitangent, 3);
    if (semantic != "TEXCOORD") return;
    const std::uint64_t set = file_.count(input, "set", 0);
    if (set > INT32_MAX) file_.fail(input, "a set from 0 to 2147483647", std::to_string(set));
    if (!inputs.uvs.contains(set) && inputs.uvs.size() < most_uv_sets)
      inputs.uvs.emplace(set, Input{offset, read_source(file_.target(input, "source", "source"), 2)});
  }

  Inputs read_inputs(const pugi::xml_node& group) {
    Inputs inputs;
    constexpr std::uint64_t most_offset = 1000;
    for (const pugi::xml_node input : group.children("input")) {
      const std::uint64_t offset = file_.count(input, "offset", 0);
      if (offset > most_offset) file_.fail(input, "an offset from 0 to 1000", std::to_string(offset));
      inputs.stride = std::max(inputs.stride, offset + 1);
      if (std::string_view(input.attribute("semantic").value()) != "VERTEX") {
        add_input(input, offset, inputs);
        continue;
      }
      for (const pugi::xml_node of_vertex : file_.target(input, "source", "vertices").children("input"))
        add_input(of_vertex, offset, inputs);
    }
    if (!inputs.position) file_.fail(group, "an input VERTEX whose vertices have POSITION", "none");
    return inputs;
  }

  // Accounts for the corners of polygons, and the triangles that they become.
  void take(const pugi::xml_node& group, const Inputs& inputs, std::uint64_t triangles,
            std::uint64_t corners) {
    const std::uint64_t list = sizeof(std::vector<std::uint64_t>) + 16;  // with the allocator's own
    std::uint64_t corner = inputs.stride * sizeof(std::uint64_t) + sizeof(Vec3<double>);
    if (inputs.normal) corner += sizeof(Vec3<double>);
    if (inputs.tangent) corner += sizeof(Vec4<double>);
    corner += inputs.uvs.size() * sizeof(Vec2<double>);
    budget_.take(triangles * (triangle_bytes + list) + corners * corner, ColladaPlace{file_, group},
                 std::to_string(triangles) + " triangles of " + std::to_string(corners) + " corners");
  }

  // The indices of each polygon, `stride` per corner.
  std::vector<std::vector<std::uint64_t>> read_polygons(const pugi::xml_node& group, const Inputs& inputs) {
    const std::uint64_t stride = inputs.stride;
    const std::string_view kind = group.name();
    std::vector<std::vector<std::uint64_t>> polygons;
    const auto add = [&](const std::vector<std::uint64_t>& from,
                         std::initializer_list<std::uint64_t> corners) {
      std::vector<std::uint64_t>& polygon = polygons.emplace_back();
      for (const std::uint64_t c : corners)
        polygon.insert(polygon.end(), from.begin() + static_cast<std::ptrdiff_t>(c * stride),
                       from.begin() + static_cast<std::ptrdiff_t>((c + 1) * stride));
    };
    if (kind == "polylist" && group.child("p").next_sibling("p")) file_.fail(group, "one <p>", "several");
    for (const pugi::xml_node p : group.children("p")) {
      std::vector<std::uint64_t> indices = file_.indices(p);
      if (indices.size() % stride != 0)
        file_.fail(p, "a multiple of " + std::to_string(stride) + " indices", std::to_string(indices.size()));
      const std::uint64_t corners = indices.size() / stride;
      const bool shares = kind == "tristrips" || kind == "trifans";  // corners, which become several
      const std::uint64_t triangles =
          kind == "triangles" ? corners / 3 : corners - std::min<std::uint64_t>(corners, 2);
      take(group, inputs, triangles, shares ? 3 * triangles : corners);
      if (kind == "triangles") {
        if (corners % 3 != 0) file_.fail(p, "a multiple of 3 corners", std::to_string(corners));
        for (std::uint64_t c = 0; c < corners; c += 3) add(indices, {c, c + 1, c + 2});
      } else if (kind == "tristrips") {
        for (std::uint64_t c = 0; c + 2 < corners; ++c) add(indices, {c, c + 1 + c % 2, c + 2 - c % 2});
      } else if (kind == "trifans") {
        for (std::uint64_t c = 1; c + 1 < corners; ++c) add(indices, {0, c, c + 1});
      } else if (kind == "polygons") {
        polygons.push_back(std::move(indices));
      } else {
        add_polylist(group, indices, stride, polygons);
      }
    }
    const bool counted = kind == "triangles" || kind == "polylist" || kind == "polygons";
    if (const std::uint64_t stated = file_.count(group, "count", polygons.size());
        counted && stated != polygons.size())
      file_.fail(group, "a count of its " + std::to_string(polygons.size()) + " polygons",
                 std::to_string(stated));
    return polygons;
  }

  void add_polylist(const pugi::xml_node& group, const std::vector<std::uint64_t>& indices,
                    std::uint64_t stride, std::vector<std::vector<std::uint64_t>>& polygons) const {
    const std::uint64_t corners = indices.size() / stride;
    auto at = indices.begin();
    std::uint64_t left = corners;
    for (const std::uint64_t n : file_.indices(group.child("vcount"))) {
      if (n > left) break;
      const auto end = at + static_cast<std::ptrdiff_t>(n * stride);
      polygons.emplace_back(at, end);
      at = end;
      left -= n;
    }
    if (left > 0)
      file_.fail(group, "a <vcount> that sums up to the " + std::to_string(corners) + " corners of its <p>",
                 "another sum");
  }

  template <std::size_t N>
  std::array<double, N> vector_of(const pugi::xml_node& group, const Input& input,
                                  const std::uint64_t* corner) const {
    const std::uint64_t index = corner[input.offset];
    if (index >= input.source.count)
      file_.fail(group,
                 "indices below " + std::to_string(input.source.count) + " at offset " +
                     std::to_string(input.offset),
                 std::to_string(index));
    std::array<double, N> result;
    for (std::size_t k = 0; k < N; ++k) result[k] = input.source.component(index, k);
    return result;
  }

  void add_corner(const pugi::xml_node& group, const Inputs& inputs, const std::uint64_t* corner,
                  bool tangents, Primitive& primitive) const {
    Mesh& mesh = primitive.data;
    const auto vec3 = [&](const Input& input) {
      const auto a = vector_of<3>(group, input, corner);
      return Vec3<double>{a[0], a[1], a[2]};
    };
    mesh.positions.push_back(vec3(*inputs.position));
    if (inputs.normal) mesh.normals.push_back(vec3(*inputs.normal));
    if (tangents) {
      const Vec3<double> t = vec3(*inputs.tangent);
      mesh.tangents.push_back(with_side(mesh.normals.back(), t, vec3(*inputs.bitangent)));
    }
    std::size_t number = 0;
    for (const auto& [set, input] : inputs.uvs) {
      if (number > 0 && !tangents) break;
      const auto uv = vector_of<2>(group, input, corner);
      (number == 0 ? mesh.uvs : primitive.other_uvs[number - 1].second).push_back({uv[0], uv[1]});
      ++number;
    }
  }

  const Collada& file_;
  Budget& budget_;
};

}  // namespace

void read_geometry(const Collada& file, const pugi::xml_node& geometry, std::size_t number,
                   const Instances& instances, Budget& budget, Asset& asset) {
  const pugi::xml_node mesh = geometry.child("mesh");
  if (!mesh) {
    asset.skipped.push_back({number, 0, "a geometry without <mesh> has no triangles"});
    return;
  }
  budget.take(instances.size() * sizeof(Eigen::Matrix4d), ColladaPlace{file, mesh}, "its instances");
  GeometryReader reader(file, budget);
  std::size_t group_number = 0;
  for (const pugi::xml_node group : mesh.children()) {
    const std::string_view kind = group.name();
    const bool lines = kind == "lines" || kind == "linestrips";
    if (!lines && kind != "triangles" && kind != "polylist" && kind != "polygons" && kind != "tristrips" &&
        kind != "trifans")
      continue;
    const std::size_t p = group_number++;
    if (lines || group.child("ph")) {
      asset.skipped.push_back(
          {number, p, lines ? "lines have no triangles" : "polygons with holes (ph) are not read"});
      continue;
    }
    Primitive primitive;
    primitive.mesh = number;
    primitive.primitive = p;
    primitive.name = geometry.attribute(geometry.attribute("name") ? "name" : "id").value();
    reader.read(group, primitive);
    if (primitive.data.triangles.empty()) {
      asset.skipped.push_back({number, p, "no polygons have no triangles"});
      continue;
    }
    primitive.instances = instances;
    primitive.sign = SignConvention::raw;
    asset.primitives.push_back(std::move(primitive));
  }
}

}  // namespace darboux::io
