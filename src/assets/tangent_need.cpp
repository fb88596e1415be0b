#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <darboux/file_tangents.h>
#include <darboux/tangent_need.h>

#include "flat_normal_maps.h"
#include "io/accessor.h"
#include "io/gltf_file.h"
#include "io/tangent_space.h"

namespace darboux {
namespace {

using io::JsonCursor;

// The meshes that a scene shows, through nodes that may form invalid cycles.
std::vector<bool> meshes_in_scenes(const GltfFile& file) {
  const JsonCursor root = file.root();
  std::vector<bool> shown(root.has("meshes") ? root.at("meshes").size() : 0, false);
  if (!root.has("scenes") || !root.has("nodes")) return shown;
  std::vector<bool> seen(root.at("nodes").size(), false);
  std::vector<std::size_t> open;
  const auto take = [&](const JsonCursor& owner, const char* key) {
    if (!owner.has(key)) return;
    const JsonCursor list = owner.at(key);
    for (std::size_t i = 0; i < list.size(); ++i) {
      file.element("nodes", list.at(i));
      const std::size_t node = list.at(i).integer();
      if (!seen[node]) open.push_back(node);
      seen[node] = true;
    }
  };
  const JsonCursor scenes = root.at("scenes");
  for (std::size_t s = 0; s < scenes.size(); ++s) take(scenes.at(s), "nodes");
  while (!open.empty()) {
    const JsonCursor node = root.at("nodes").at(open.back());
    open.pop_back();
    take(node, "children");
    if (!node.has("mesh")) continue;
    file.element("meshes", node.at("mesh"));
    shown[node.at("mesh").integer()] = true;
  }
  return shown;
}

std::string name_of(const JsonCursor& owner) {
  return owner.has("name") && owner.at("name").json().is_string() ? owner.at("name").text() : std::string();
}

std::size_t accessor_count(const JsonCursor& accessor) {
  return accessor.at("count").integer(1, 0xffffffff);
}

std::size_t accessor_bytes(const JsonCursor& accessor) {
  return accessor_count(accessor) * io::accessor_layout(accessor).element_bytes;
}

std::size_t triangle_count(std::uint64_t mode, std::size_t corners) {
  if (mode == io::triangles) return corners / 3;
  return (mode == io::triangle_strip || mode == io::triangle_fan) && corners > 2 ? corners - 2 : 0;
}

class Planner {
 public:
  Planner(const GltfFile& file, NeedLevel level) : file_(file), shown_(meshes_in_scenes(file)) {
    if (level != NeedLevel::spec) off_ = {true, io::animated_pointers(file)};
    if (level == NeedLevel::pixels) flat_maps_.emplace(file);
    if (file.root().has("materials")) readers_.resize(file.root().at("materials").size());
    if (file.root().has("accessors")) uses_.resize(file.root().at("accessors").size());
  }

  TangentNeeds plan() {
    if (!file_.root().has("meshes")) return {};
    const JsonCursor meshes = file_.root().at("meshes");
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const JsonCursor primitives = meshes.at(m).at("primitives");
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        PrimitiveNeed need = plan(primitives.at(p));
        need.mesh = m;
        need.primitive = p;
        need.name = name_of(meshes.at(m));
        need.in_scene = shown_[m];
        result_.primitives.push_back(std::move(need));
      }
    }
    NeedTotals& totals = result_.totals;
    for (const PrimitiveNeed& need : result_.primitives) {
      totals.needed += need.need == TangentNeed::needed;
      totals.missing += need.need == TangentNeed::missing;
      totals.idle += need.need == TangentNeed::idle;
      totals.carried += need.carried;
    }
    for (std::size_t accessor = 0; accessor < uses_.size(); ++accessor) {
      const Uses& uses = uses_[accessor];
      if (!uses.as_tangent && !uses.as_geometry) continue;
      const std::size_t bytes = bytes_of(accessor);
      if (uses.as_geometry) totals.geometry_bytes += bytes;
      if (uses.as_tangent) totals.tangent_bytes += bytes;
      if (uses.as_tangent && !uses.as_tangent_read) totals.idle_bytes += bytes;
    }
    return std::move(result_);
  }

 private:
  PrimitiveNeed plan(const JsonCursor& primitive) {
    PrimitiveNeed result;
    const JsonCursor attributes = primitive.at("attributes");
    const std::uint64_t mode = primitive.integer_or("mode", io::triangles);
    const bool drawn_as_triangles =
        mode == io::triangles || mode == io::triangle_strip || mode == io::triangle_fan;
    result.carried = attributes.has("TANGENT");
    result.has_normals = attributes.has("NORMAL");
    if (primitive.has("material"))
      result.material = name_of(file_.element("materials", primitive.at("material")));
    if (drawn_as_triangles) {
      add_reasons(primitive, attributes, result);
      result.triangles = triangles_of(primitive, attributes, mode);
    }
    const bool read = !result.reasons.empty();
    result.need = !result.carried              ? (read ? TangentNeed::missing : TangentNeed::none)
                  : read && result.has_normals ? TangentNeed::needed
                                               : TangentNeed::idle;
    add_bytes(primitive, attributes, drawn_as_triangles, result);
    return result;
  }

  void add_reasons(const JsonCursor& primitive, const JsonCursor& attributes, PrimitiveNeed& result) {
    const auto has_set = [&](std::uint64_t set) {
      return attributes.has(("TEXCOORD_" + std::to_string(set)).c_str());
    };
    for (const std::size_t material : io::materials_of(file_, primitive)) {
      const Readers& readers = readers_of(material);
      // Anisotropy without TANGENT requires the normal texture, whatever its scale.
      const bool has_map = readers.normal_texcoord && has_set(*readers.normal_texcoord);
      for (const auto& [r, note] : readers.of_frame) {
        const bool derivable = r.is_normal_map ? has_set(r.texcoord) : has_map;
        result.reasons.push_back({std::string(r.rule), r.pointer,
                                  r.has_texture ? static_cast<int>(r.texcoord) : -1, r.transform.has_value(),
                                  derivable && result.has_normals, note});
      }
    }
    result.derivable =
        !result.reasons.empty() && std::all_of(result.reasons.begin(), result.reasons.end(),
                                               [](const NeedReason& reason) { return reason.derivable; });
  }

  std::size_t triangles_of(const JsonCursor& primitive, const JsonCursor& attributes, std::uint64_t mode) {
    if (primitive.has("indices"))
      return triangle_count(mode, accessor_count(file_.element("accessors", primitive.at("indices"))));
    if (!attributes.has("POSITION")) return 0;
    return triangle_count(mode, accessor_count(file_.element("accessors", attributes.at("POSITION"))));
  }

  // Counts the bytes of the primitive's tangents, and its accessors for the totals.
  void add_bytes(const JsonCursor& primitive, const JsonCursor& attributes, bool drawn_as_triangles,
                 PrimitiveNeed& result) {
    std::vector<std::size_t> tangents;
    const auto take = [&](const JsonCursor& accessor, bool tangent) {
      const std::size_t index = accessor.integer();
      if (index >= uses_.size()) file_.element("accessors", accessor);  // refuses it
      Uses& uses = uses_[index];
      uses.as_geometry = uses.as_geometry || drawn_as_triangles;
      if (!tangent) return;
      uses.as_tangent = true;
      uses.as_tangent_read = uses.as_tangent_read || result.need == TangentNeed::needed;
      if (std::find(tangents.begin(), tangents.end(), index) == tangents.end()) tangents.push_back(index);
    };
    const auto take_all = [&](const JsonCursor& list) {
      for (const auto& [key, value] : list.json().items()) take(list.at(key.c_str()), key == "TANGENT");
    };
    take_all(attributes);
    if (primitive.has("targets")) {
      const JsonCursor targets = primitive.at("targets");
      for (std::size_t t = 0; t < targets.size(); ++t) take_all(targets.at(t));
    }
    if (primitive.has("indices")) take(primitive.at("indices"), false);
    for (const std::size_t accessor : tangents) result.tangent_bytes += bytes_of(accessor);
  }

  // The properties of a material that read the frame, and the uv set of its normal texture.
  struct Reader {
    io::FrameReader reader;
    std::string note;
  };
  struct Readers {
    std::vector<Reader> of_frame;
    std::optional<std::uint64_t> normal_texcoord;
  };
  const Readers& readers_of(std::size_t material) {
    auto& readers = readers_[material];
    if (readers) return *readers;
    readers.emplace();
    for (const io::FrameReader& r : io::frame_readers(file_, material))
      if (r.rule == "normal_texture") readers->normal_texcoord = r.texcoord;
    for (io::FrameReader& r : io::frame_readers(file_, material, off_)) {
      FlatNormalMaps::Answer map;
      if (flat_maps_ && r.is_normal_map) map = flat_maps_->of(r);
      if (!map.flat) readers->of_frame.push_back({std::move(r), std::move(map.note)});
    }
    return *readers;
  }

  std::size_t bytes_of(std::size_t accessor) const {
    return accessor_bytes(file_.root().at("accessors").at(accessor));
  }

  struct Uses {
    bool as_geometry = false, as_tangent = false;
    bool as_tangent_read = false;  // by a primitive that needs it
  };

  const GltfFile& file_;
  io::SwitchedOff off_{};
  std::optional<FlatNormalMaps> flat_maps_{};
  std::vector<bool> shown_;
  std::vector<std::optional<Readers>> readers_;  // of each material, once needed
  std::vector<Uses> uses_;                       // of each accessor
  TangentNeeds result_;
};

}  // namespace

TangentNeeds tangent_need(const GltfDocument& document, NeedLevel level) {
  return Planner(document.file(), level).plan();
}

TangentNeeds tangent_need(const std::string& path, NeedLevel level, const ReadOptions& options) {
  const GltfFile file = io::load_gltf_json(path, options);
  return Planner(file, level).plan();
}

void count_splits(const std::string& path, TangentNeeds& needs, const ReadOptions& options) {
  GltfDocument document = GltfDocument::load(path, options);
  FileTangentOptions needed;
  needed.only_needed = true;
  const FileTangents made = add_tangents(document, needed);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> added;
  for (const PrimitiveTangents& p : made.primitives)
    added[{p.mesh, p.primitive}] = p.vertices - std::min(p.vertices, p.old_vertices);
  for (PrimitiveNeed& need : needs.primitives)
    if (const auto found = added.find({need.mesh, need.primitive});
        found != added.end() && !need.reasons.empty())
      need.splits = found->second;
}

std::vector<DroppedTangents> dropped_tangents(const TangentNeeds& before, const TangentNeeds& after) {
  using Key = std::tuple<std::string, std::string, std::size_t, std::size_t>;
  // Keys that match primitives before and after, the most reliable first; none where a key does not apply.
  using MakeKey = std::optional<Key> (*)(const PrimitiveNeed&);
  constexpr MakeKey keys[] = {[](const PrimitiveNeed& p) -> std::optional<Key> {
                                if (p.name.empty()) return std::nullopt;
                                return Key{p.name, p.material, p.triangles, 0};
                              },
                              [](const PrimitiveNeed& p) -> std::optional<Key> {
                                if (p.name.empty()) return std::nullopt;
                                return Key{p.name, p.material, 0, 0};
                              },
                              [](const PrimitiveNeed& p) -> std::optional<Key> {
                                if (p.material.empty()) return std::nullopt;
                                return Key{"", p.material, p.triangles, 0};
                              },
                              [](const PrimitiveNeed& p) -> std::optional<Key> {
                                return Key{"", "", p.mesh, p.primitive};
                              },
                              [](const PrimitiveNeed&) -> std::optional<Key> { return Key{}; }};
  // Among primitives with equal keys, those with the same need are matched.
  enum { as_needed, as_lost, as_other, kinds };
  const auto kind = [](const PrimitiveNeed& p) {
    if (p.need == TangentNeed::needed) return as_needed;
    return p.reasons.empty() ? as_other
                             : as_lost;  // without TANGENT, or without NORMAL, which makes it useless
  };
  using Primitives = std::vector<const PrimitiveNeed*>;
  struct Group {
    std::array<Primitives, kinds> before, after;
  };
  Primitives open_before, open_after;
  for (const PrimitiveNeed& p : before.primitives) open_before.push_back(&p);
  for (const PrimitiveNeed& p : after.primitives) open_after.push_back(&p);
  std::vector<DroppedTangents> result;
  for (const MakeKey key : keys) {
    std::map<Key, Group> groups;
    Primitives left_before, left_after;
    for (const PrimitiveNeed* p : open_before)
      if (const auto k = key(*p))
        groups[*k].before[kind(*p)].push_back(p);
      else
        left_before.push_back(p);
    for (const PrimitiveNeed* p : open_after)
      if (const auto k = key(*p))
        groups[*k].after[kind(*p)].push_back(p);
      else
        left_after.push_back(p);
    for (auto& entry : groups) {
      Group& group = entry.second;
      const auto pair_up = [&](int b, int a, bool dropped) {
        Primitives &from = group.before[b], &to = group.after[a];
        const std::size_t n = std::min(from.size(), to.size());
        for (std::size_t i = 0; dropped && i < n; ++i) result.push_back({from[i], to[i]});
        from.erase(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(n));
        to.erase(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(n));
      };
      for (int k = 0; k < kinds; ++k) pair_up(k, k, false);
      pair_up(as_needed, as_lost, true);
      for (int b = 0; b < kinds; ++b)
        for (int a = 0; a < kinds; ++a) pair_up(b, a, false);
      for (int k = 0; k < kinds; ++k) {
        left_before.insert(left_before.end(), group.before[k].begin(), group.before[k].end());
        left_after.insert(left_after.end(), group.after[k].begin(), group.after[k].end());
      }
    }
    open_before = std::move(left_before);
    open_after = std::move(left_after);
  }
  std::sort(result.begin(), result.end(), [](const DroppedTangents& a, const DroppedTangents& b) {
    return std::pair(a.after->mesh, a.after->primitive) < std::pair(b.after->mesh, b.after->primitive);
  });
  return result;
}

}  // namespace darboux
