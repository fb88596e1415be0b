#include "scene_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <utility>

#include <darboux/elementary.h>
#include <darboux/error.h>

#include "base/linear_algebra.h"
#include "base/text.h"
#include "files.h"
#include "gltf_file.h"
#include "json_cursor.h"

namespace darboux::io {
namespace {

constexpr std::uintmax_t most_scene_bytes = std::uintmax_t{128} << 20;
constexpr double most_condition = 1e12;  // of a placement, as in plan_scene()

// Random numbers of splitmix64 (S. Vigna, in the public domain): the same on every machine.
class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}
  /// In [0, 1), a multiple of 2^-53.
  double uniform() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  /// A point of the open unit disk, and its squared distance from the centre.
  std::array<double, 3> in_disk() {
    for (;;) {
      const double x = 2 * uniform() - 1, y = 2 * uniform() - 1, square = x * x + y * y;
      if (square < 1) return {x, y, square};
    }
  }
  /// A direction, uniformly over the sphere [Marsaglia1972].
  Eigen::Vector3d direction() {
    const auto [x, y, square] = in_disk();
    const double factor = 2 * std::sqrt(1 - square);
    return {factor * x, factor * y, 1 - 2 * square};
  }
  /// A rotation, uniformly over all [Marsaglia1972].
  Eigen::Quaterniond rotation() {
    const auto [x, y, square] = in_disk();
    for (;;) {
      const auto [z, w, other] = in_disk();
      if (other == 0) continue;
      const double factor = std::sqrt((1 - square) / other);
      return Eigen::Quaterniond(factor * w, x, y, factor * z);
    }
  }

 private:
  std::uint64_t state_;
};

double number_above(const JsonCursor& value, double least) {
  const double x = value.number();
  if (!(x > least)) value.fail("a number above " + shortest(least));
  return x;
}

template <std::size_t N>
std::array<double, N> number_list(const JsonCursor& value) {
  const std::string expected = "an array of " + std::to_string(N) + " numbers";
  if (!value.json().is_array()) value.fail(expected);
  if (value.size() != N) value.fail(expected, "one of " + std::to_string(value.size()));
  std::array<double, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = value.at(i).number();
  return result;
}

Eigen::Vector3d vector_of(const JsonCursor& value) {
  const auto x = number_list<3>(value);
  return {x[0], x[1], x[2]};
}

class SceneReader {
 public:
  SceneReader(const std::string& path, const Json& json, const MakeSurface& make_surface)
      : root_(JsonCursor::with_pointers(path, json)), make_surface_(make_surface) {}

  SceneFile read() {
    file_.request.frame_angle_rad = std::numbers::pi / 180;
    root_.expect_keys({"$schema", "surfaces", "materials", "cameras", "instances", "scatter", "request"});
    read_surfaces(root_.at("surfaces"));
    if (root_.has("materials")) read_materials(root_.at("materials"));
    read_cameras(root_.at("cameras"));
    if (root_.has("instances")) read_instances(root_.at("instances"));
    if (root_.has("scatter")) read_scatter(root_.at("scatter"));
    if (file_.scene.instances.empty()) root_.fail("instances or scatter", "neither");
    if (root_.has("request")) read_request(root_.at("request"));
    return std::move(file_);
  }

 private:
  using Names = std::unordered_map<std::string, std::uint32_t>;

  void read_surfaces(const JsonCursor& list) {
    list.has("");
    if (list.json().empty()) list.fail("at least one surface", "none");
    for (const auto& [name, text] : list.json().items()) {
      const JsonCursor surface = list.at(name);
      try {
        file_.scene.surfaces.push_back(make_surface_(surface.text()));
      } catch (const ParameterError& error) {
        surface.refuse(error.what());
      }
      surface_index_.emplace(name, static_cast<std::uint32_t>(file_.surface_names.size()));
      file_.surface_names.push_back(name);
    }
  }

  void read_materials(const JsonCursor& list) {
    list.has("");
    for (const auto& [name, value] : list.json().items()) {
      const JsonCursor material = list.at(name);
      material.expect_keys({"normal_map", "clearcoat_normal_map", "anisotropy", "double_sided", "see_through",
                            "displacement"});
      const auto flag = [&](const char* key) { return material.has(key) && material.at(key).boolean(); };
      SceneMaterial m;
      m.name = name;
      m.normal_map = flag("normal_map");
      m.clearcoat_normal_map = flag("clearcoat_normal_map");
      m.anisotropy = flag("anisotropy");
      m.double_sided = flag("double_sided");
      m.see_through = flag("see_through");
      if (material.has("displacement")) {
        m.displacement = material.at("displacement").number();
        if (!(m.displacement >= 0)) material.at("displacement").fail("a number not below 0");
      }
      material_index_.emplace(name, static_cast<std::uint32_t>(file_.scene.materials.size()));
      file_.scene.materials.push_back(std::move(m));
    }
  }

  void read_cameras(const JsonCursor& list) {
    if (list.size() == 0) list.fail("at least one camera", "none");
    for (std::size_t i = 0; i < list.size(); ++i) file_.cameras.push_back(camera_of(list.at(i)));
  }

  static NamedCamera camera_of(const JsonCursor& value) {
    value.expect_keys(
        {"name", "perspective", "orthographic", "eye", "target", "up", "width_px", "height_px"});
    NamedCamera result;
    Camera& camera = result.camera;
    if (value.has("name")) result.name = value.at("name").text();
    const bool perspective = value.has("perspective");
    if (perspective == value.has("orthographic"))
      value.fail("either perspective or orthographic", perspective ? "both" : "neither");
    const JsonCursor lens = value.at(perspective ? "perspective" : "orthographic");
    const double zero = 0, lowest = std::numeric_limits<double>::lowest();
    if (perspective) {
      lens.expect_keys({"vertical_field_of_view_deg", "near", "far"});
      const JsonCursor angle = lens.at("vertical_field_of_view_deg");
      const double degrees = angle.number();
      if (!(degrees > 0 && degrees < 180)) angle.fail("a number above 0 and below 180");
      camera.vertical_field_of_view_rad = degrees * (std::numbers::pi / 180);
    } else {
      lens.expect_keys({"height", "near", "far"});
      camera.projection = Camera::Projection::orthographic;
      camera.view_height = number_above(lens.at("height"), 0);
    }
    camera.near_distance = number_above(lens.at("near"), perspective ? zero : lowest);
    camera.far_distance = number_above(lens.at("far"), camera.near_distance);
    constexpr std::uint64_t most_pixels = 65535;
    if (value.has("width_px"))
      camera.width_px = static_cast<int>(value.at("width_px").integer(1, most_pixels));
    if (value.has("height_px"))
      camera.height_px = static_cast<int>(value.at("height_px").integer(1, most_pixels));
    const Eigen::Vector3d eye = vector_of(value.at("eye")), target = vector_of(value.at("target"));
    const Eigen::Vector3d up = value.has("up") ? vector_of(value.at("up")) : Eigen::Vector3d::UnitZ();
    try {
      camera.pose = Camera::look_at(eye, target, up);
      camera.check();
    } catch (const ParameterError& error) {
      value.refuse(error.what());
    }
    return result;
  }

  static std::uint32_t index_in(const Names& names, const JsonCursor& name, const char* what) {
    const auto found = names.find(name.text());
    if (found != names.end()) return found->second;
    constexpr std::size_t most_listed = 10;
    std::vector<std::string> known;
    for (const auto& entry : names) known.push_back(entry.first);
    std::sort(known.begin(), known.end());
    const bool more = known.size() > most_listed;
    if (more) known.resize(most_listed);
    name.fail(std::string("one of the ") + what +
              (known.empty() ? " (there are none)" : " " + joined(known)) + (more ? ", ..." : ""));
  }

  std::uint32_t default_material() {
    if (!default_material_) {
      default_material_ = static_cast<std::uint32_t>(file_.scene.materials.size());
      file_.scene.materials.push_back({});
    }
    return *default_material_;
  }

  void read_instances(const JsonCursor& list) {
    const std::size_t count = list.size();
    if (count > most_scene_instances) refuse_count(list, count);
    file_.scene.instances.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const JsonCursor value = list.at(i);
      value.expect_keys({"surface", "material", "translation", "rotation", "scale", "matrix"});
      SceneInstance instance;
      instance.surface = index_in(surface_index_, value.at("surface"), "surfaces");
      instance.material = value.has("material") ? index_in(material_index_, value.at("material"), "materials")
                                                : default_material();
      instance.placement = placement_of(value);
      file_.scene.instances.push_back(instance);
    }
  }

  [[noreturn]] static void refuse_count(const JsonCursor& place, std::size_t got) {
    place.fail("at most " + std::to_string(most_scene_instances) + " instances in all", std::to_string(got));
  }

  static Eigen::Affine3d placement_of(const JsonCursor& value) {
    Eigen::Affine3d placement = Eigen::Affine3d::Identity();
    if (value.has("matrix")) {
      for (const char* key : {"translation", "rotation", "scale"})
        if (value.has(key)) value.at(key).fail("no other placement beside a matrix", key);
      const JsonCursor matrix = value.at("matrix");
      const auto m = number_list<16>(matrix);
      if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        matrix.fail("a matrix by columns, whose last row is 0 0 0 1", "another row");
      placement.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
      const Eigen::Vector3d s = singular_value_decomposition(placement.linear()).values;
      if (!(s[2] * most_condition > s[0])) matrix.fail("an invertible matrix", "a singular one");
      return placement;
    }
    if (value.has("translation")) placement.translation() = vector_of(value.at("translation"));
    if (value.has("rotation")) {
      const JsonCursor rotation = value.at("rotation");
      const auto q = number_list<4>(rotation);
      const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
      // A quaternion with rounded components is meant to have length 1.
      if (const double length = quaternion.norm(); !(std::fabs(length - 1) < 1e-3))
        rotation.fail("a quaternion x, y, z, w of length 1", "one of length " + rounded(length, 4));
      placement.linear() = quaternion.normalized().toRotationMatrix();
    }
    if (value.has("scale")) {
      const JsonCursor scale = value.at("scale");
      Eigen::Vector3d s = Eigen::Vector3d::Ones();
      if (scale.json().is_array())
        s = vector_of(scale);
      else if (scale.json().is_number())
        s *= scale.number();
      else
        scale.fail("a number or an array of 3 numbers");
      const double least = s.cwiseAbs().minCoeff(), most = s.cwiseAbs().maxCoeff();
      if (!(least * most_condition > most))
        scale.fail("numbers other than 0, none 1e12 times another", scale.json().dump());
      placement.linear() = placement.linear() * s.asDiagonal();
    }
    return placement;
  }

  // The indices of the names in a list, or all indices.
  std::vector<std::uint32_t> named(const JsonCursor& owner, const char* key, const Names& names) {
    std::vector<std::uint32_t> result;
    if (owner.has(key)) {
      const JsonCursor list = owner.at(key);
      if (list.size() == 0) list.fail("at least one name", "none");
      for (std::size_t i = 0; i < list.size(); ++i) result.push_back(index_in(names, list.at(i), key));
    } else {
      for (std::uint32_t i = 0; i < names.size(); ++i) result.push_back(i);
    }
    return result;
  }

  void read_scatter(const JsonCursor& value) {
    value.expect_keys({"count", "seed", "eye", "radius", "nearest_radii", "farthest_radii", "scale",
                       "surfaces", "materials"});
    const std::size_t before = file_.scene.instances.size();
    const JsonCursor count_place = value.at("count");
    const std::uint64_t count = count_place.integer(1);
    if (count > most_scene_instances - before) refuse_count(count_place, before + count);
    const auto positive_or = [&](const char* key, double fallback) {
      return value.has(key) ? number_above(value.at(key), 0) : fallback;
    };
    const double radius = positive_or("radius", 1), scale = positive_or("scale", 1);
    const double nearest = number_above(value.at("nearest_radii"), 0);
    const JsonCursor farthest_place = value.at("farthest_radii");
    const double farthest = farthest_place.number();
    if (!(farthest >= nearest)) farthest_place.fail("a number not below nearest_radii, " + shortest(nearest));
    if (!std::isfinite(farthest / nearest))
      farthest_place.fail("a finite multiple of nearest_radii, " + shortest(nearest));
    const Eigen::Vector3d eye = value.has("eye") ? vector_of(value.at("eye")) : Eigen::Vector3d::Zero();
    const std::vector<std::uint32_t> surfaces = named(value, "surfaces", surface_index_);
    std::vector<std::uint32_t> materials = named(value, "materials", material_index_);
    if (materials.empty()) materials.push_back(default_material());

    SplitMix random(value.integer_or("seed", 0));
    const double log_ratio = darboux::log(farthest / nearest);
    file_.scene.instances.reserve(before + count);
    for (std::uint64_t i = 0; i < count; ++i) {
      SceneInstance instance;
      instance.material = materials[i % materials.size()];
      instance.surface = surfaces[i / materials.size() % surfaces.size()];
      const double distance = radius * nearest * darboux::exp(random.uniform() * log_ratio);
      instance.placement.translation() = eye + distance * random.direction();
      instance.placement.linear() = scale * random.rotation().toRotationMatrix();
      file_.scene.instances.push_back(instance);
    }
  }

  void read_request(const JsonCursor& value) {
    value.expect_keys({"attributes", "chord_px", "chord", "angle_deg"});
    SceneRequest& request = file_.request;
    if (value.has("attributes")) {
      const JsonCursor list = value.at("attributes");
      if (list.size() == 0) list.fail("at least one attribute", "none");
      request.attributes = {};
      for (std::size_t i = 0; i < list.size(); ++i) request.attributes |= attribute_of(list.at(i));
    }
    if (value.has("chord")) {
      request.chord = number_above(value.at("chord"), 0);
      request.chord_px = std::numeric_limits<double>::infinity();
    }
    if (value.has("chord_px")) request.chord_px = number_above(value.at("chord_px"), 0);
    if (value.has("angle_deg"))
      request.frame_angle_rad = number_above(value.at("angle_deg"), 0) * (std::numbers::pi / 180);
  }

  static Attribute attribute_of(const JsonCursor& name) {
    std::vector<std::string> known;
    for (std::size_t a = 0; a < attribute_count; ++a) {
      if (name.text() == attribute_infos[a].name) return static_cast<Attribute>(a);
      known.emplace_back(attribute_infos[a].name);
    }
    name.fail("one of the attributes " + joined(known));
  }

  JsonCursor root_;
  const MakeSurface& make_surface_;
  Names surface_index_, material_index_;
  std::optional<std::uint32_t> default_material_;
  SceneFile file_;
};

}  // namespace

SceneFile read_scene_file(const std::string& path, const MakeSurface& make_surface) {
  expect_regular_file(path);
  std::error_code none;
  if (const std::uintmax_t size = std::filesystem::file_size(path, none); size > most_scene_bytes)
    throw FileError(path, expected_got("at most 128 MiB of JSON; scatter makes many instances of a few lines",
                                       std::to_string(size) + " bytes"));
  const Json json = parse_json(path, read_file(path));
  if (!json.is_object()) throw FileError(path, expected_got("a JSON object", json.type_name()));
  return SceneReader(path, json, make_surface).read();
}

}  // namespace darboux::io
