#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include <darboux/error.h>
#include <darboux/file_tangents.h>
#include <darboux/tangent_need.h>

#include "base/text.h"
#include "io/accessor.h"
#include "io/gltf_file.h"

namespace darboux {
namespace {

using io::Json;
using io::JsonCursor;

// Extensions that reference no accessors and no bufferViews other than those that each_accessor() and
// each_view() visit.
bool names_no_data(std::string_view extension) {
  constexpr std::string_view families[] = {"KHR_materials_", "KHR_texture_",  "KHR_lights_",
                                           "EXT_texture_",   "MSFT_packing_", "MSFT_texture_"};
  constexpr std::string_view names[] = {
      "KHR_mesh_quantization",   "KHR_animation_pointer",  "KHR_node_visibility",
      "EXT_mesh_gpu_instancing", "KHR_xmp_json_ld",        "KHR_node_hoverability",
      "KHR_materials_variants",  "KHR_node_selectability", "EXT_lights_image_based"};
  return std::any_of(std::begin(families), std::end(families),
                     [&](std::string_view family) { return extension.starts_with(family); }) ||
         std::find(std::begin(names), std::end(names), extension) != std::end(names);
}

// Calls f with the number under a key, if there is one.
template <class F>
void number_at(Json& owner, const char* key, F& f) {
  if (!owner.is_object()) return;
  if (const auto found = owner.find(key); found != owner.end() && found->is_number()) f(*found);
}
template <class F>
void each_of(Json& owner, const char* key, F f) {
  if (!owner.is_object()) return;
  if (const auto found = owner.find(key); found != owner.end() && found->is_structured())
    for (Json& value : *found) f(value);
}

// Calls f with each index of an accessor in the document.
template <class F>
void each_accessor(Json& json, F f) {
  const auto all_values = [&](Json& values) {
    if (!values.is_object()) return;
    for (Json& value : values)
      if (value.is_number()) f(value);
  };
  each_of(json, "meshes", [&](Json& mesh) {
    each_of(mesh, "primitives", [&](Json& primitive) {
      if (primitive.contains("attributes")) all_values(primitive["attributes"]);
      each_of(primitive, "targets", all_values);
      number_at(primitive, "indices", f);
    });
  });
  each_of(json, "skins", [&](Json& skin) { number_at(skin, "inverseBindMatrices", f); });
  each_of(json, "animations", [&](Json& animation) {
    each_of(animation, "samplers", [&](Json& sampler) {
      number_at(sampler, "input", f);
      number_at(sampler, "output", f);
    });
  });
  each_of(json, "nodes", [&](Json& node) {
    each_of(node, "extensions", [&](Json& extension) {
      if (extension.is_object() && extension.contains("attributes")) all_values(extension["attributes"]);
    });
  });
}

// Calls f with the bufferView indices of an accessor's sparse part.
template <class F>
void each_view_of_sparse(Json& accessor, F& f) {
  if (!accessor.is_object() || !accessor.contains("sparse")) return;
  Json& sparse = accessor["sparse"];
  for (const char* part : {"indices", "values"})
    if (sparse.is_object() && sparse.contains(part)) number_at(sparse[part], "bufferView", f);
}
// The same for the whole accessor.
template <class F>
void each_view_of_accessor(Json& accessor, F& f) {
  number_at(accessor, "bufferView", f);
  each_view_of_sparse(accessor, f);
}
// The same for all images.
template <class F>
void each_view_of_images(Json& json, F& f) {
  each_of(json, "images", [&](Json& image) { number_at(image, "bufferView", f); });
}

// The document is inconsistent: an index names no entry.
struct NoEntry {};
std::size_t index_below(const Json& number, std::size_t size) {
  const double value = number.get<double>();
  if (!(value >= 0 && value < static_cast<double>(size))) throw NoEntry();
  return static_cast<std::size_t>(value);
}

// Removes entries from an array.
void take_out(Json& array, const std::vector<bool>& gone) {
  Json left = Json::array();
  for (std::size_t i = 0; i < array.size(); ++i)
    if (!gone[i]) left.push_back(std::move(array[i]));
  array = std::move(left);
}
// The new index of each entry.
std::vector<std::size_t> renumbered(const std::vector<bool>& gone) {
  std::vector<std::size_t> result(gone.size());
  for (std::size_t i = 0, next = 0; i < gone.size(); ++i) result[i] = gone[i] ? next : next++;
  return result;
}

// Removes accessors from a document, with the bufferViews and bytes that nothing else uses.
class Compaction {
 public:
  Compaction(GltfFile& file, const std::set<std::size_t>& accessors) : file_(file), json_(file.json) {
    gone_accessors_.assign(json_["accessors"].size(), false);
    for (const std::size_t accessor : accessors) gone_accessors_[accessor] = true;
    const std::size_t views = json_.contains("bufferViews") ? json_["bufferViews"].size() : 0;
    gone_views_.assign(views, false);
    std::vector<bool> kept(views, false);
    for (std::size_t a = 0; a < gone_accessors_.size(); ++a) {
      auto take = [&](Json& number) {
        (gone_accessors_[a] ? gone_views_ : kept)[index_below(number, views)] = true;
      };
      each_view_of_accessor(json_["accessors"][a], take);
    }
    auto keep = [&](Json& number) { kept[index_below(number, views)] = true; };
    each_view_of_images(json_, keep);
    for (std::size_t v = 0; v < views; ++v) gone_views_[v] = gone_views_[v] && !kept[v];
  }

  // Returns false if the elements of some view would no longer be equally spaced; then nothing was changed.
  bool run(std::size_t& saved) {
    mark();
    if (!measure()) return false;
    for (std::size_t b = 0; b < file_.buffers.size(); ++b) saved += shrink(b);
    take_out(json_["accessors"], gone_accessors_);
    if (json_.contains("bufferViews")) take_out(json_["bufferViews"], gone_views_);
    const std::vector<std::size_t> accessor = renumbered(gone_accessors_), view = renumbered(gone_views_);
    each_accessor(json_, [&](Json& number) { number = accessor[index_below(number, accessor.size())]; });
    auto renumber = [&](Json& number) { number = view[index_below(number, view.size())]; };
    each_of(json_, "accessors", [&](Json& one) { each_view_of_accessor(one, renumber); });
    each_view_of_images(json_, renumber);
    std::map<std::size_t, double> half_steps;
    for (const auto& [old, step] : file_.half_steps)
      if (!gone_accessors_[old]) half_steps[accessor[old]] = step;
    file_.half_steps = std::move(half_steps);
    return true;
  }

 private:
  struct View {
    std::size_t buffer, offset, length, stride;
  };

  View view(std::size_t index) const {
    const JsonCursor at = file_.root().at("bufferViews").at(index);
    file_.view_bytes(at);  // refuses what does not lie in its buffer
    return {at.at("buffer").integer(), at.integer_or("byteOffset", 0), at.at("byteLength").integer(),
            at.integer_or("byteStride", 0)};
  }

  // The bytes of an accessor's elements in its bufferView.
  struct Elements {
    std::size_t view, offset, stride, size, count;
  };
  std::optional<Elements> elements(std::size_t index) const {
    const JsonCursor accessor = file_.root().at("accessors").at(index);
    if (!accessor.has("bufferView")) return std::nullopt;
    const io::Accessor layout = io::accessor_layout(accessor);
    const std::size_t number = accessor.at("bufferView").integer();
    const View in = view(number);
    const Elements result{number, accessor.integer_or("byteOffset", 0),
                          in.stride != 0 ? in.stride : layout.element_bytes, layout.element_bytes,
                          layout.count};
    // No sum or product may wrap around.
    if (result.size > in.length || result.offset > in.length - result.size ||
        result.count - 1 > (in.length - result.size - result.offset) / result.stride)
      accessor.fail("elements within its bufferView of " + std::to_string(in.length) + " bytes", "others");
    return result;
  }

  // Marks 4-byte words that only removed data use; whole words, so that everything else stays aligned.
  void mark() {
    for (const auto& bytes : file_.buffers) gone_.emplace_back(bytes ? (bytes->size() + 3) / 4 : 0, false);
    const auto mark_gone = [&](std::size_t buffer, std::size_t begin, std::size_t end) {
      for (std::size_t w = (begin + 3) / 4; w < end / 4; ++w) gone_[buffer][w] = true;
    };
    const auto mark_kept = [&](std::size_t buffer, std::size_t begin, std::size_t end) {
      for (std::size_t w = begin / 4; w < (end + 3) / 4; ++w) gone_[buffer][w] = false;
    };
    const auto each_element = [&](std::size_t accessor, auto&& f) {
      const auto e = elements(accessor);
      if (!e) return;
      const View in = view(e->view);
      for (std::size_t i = 0; i < e->count; ++i) {
        const std::size_t begin = in.offset + e->offset + i * e->stride;
        f(in.buffer, begin, begin + e->size);
      }
    };
    for (std::size_t a = 0; a < gone_accessors_.size(); ++a)
      if (gone_accessors_[a]) each_element(a, mark_gone);
    for (std::size_t v = 0; v < gone_views_.size(); ++v)
      if (gone_views_[v]) mark_gone(view(v).buffer, view(v).offset, view(v).offset + view(v).length);
    // Data that stay take precedence: elements, and views that are used as a whole.
    std::vector<bool> whole(gone_views_.size(), true);
    auto mark_whole = [&](Json& number) { whole[index_below(number, whole.size())] = true; };
    for (std::size_t a = 0; a < gone_accessors_.size(); ++a)
      if (const auto e = elements(a)) whole[e->view] = false;
    for (std::size_t a = 0; a < gone_accessors_.size(); ++a) {
      if (gone_accessors_[a]) continue;
      each_element(a, mark_kept);
      each_view_of_sparse(json_["accessors"][a], mark_whole);
    }
    each_view_of_images(json_, mark_whole);
    for (std::size_t v = 0; v < whole.size(); ++v)
      if (whole[v] && !gone_views_[v])
        mark_kept(view(v).buffer, view(v).offset, view(v).offset + view(v).length);
    for (const std::vector<bool>& gone : gone_) {
      std::vector<std::uint32_t> before(gone.size() + 1, 0);
      for (std::size_t w = 0; w < gone.size(); ++w) before[w + 1] = before[w] + !gone[w];
      kept_before_.push_back(std::move(before));
    }
  }

  // The new offset of a byte.
  std::size_t moved(std::size_t buffer, std::size_t byte) const {
    const std::size_t word = byte / 4;
    const bool within = word < gone_[buffer].size() && !gone_[buffer][word];
    return 4 * std::size_t{kept_before_[buffer][word]} + (within ? byte % 4 : 0);
  }

  // Computes the new offsets of views and elements.
  bool measure() {
    Json accessors = json_["accessors"];
    Json views = json_.contains("bufferViews") ? json_["bufferViews"] : Json::array();
    std::vector<std::size_t> strides(views.size(), 0);
    for (std::size_t a = 0; a < accessors.size(); ++a) {
      const auto e = elements(a);
      if (gone_accessors_[a] || !e) continue;
      const View in = view(e->view);
      const auto to = [&](std::size_t byte) { return moved(in.buffer, byte); };
      const std::size_t begin = in.offset + e->offset;
      if (const std::size_t offset = to(begin) - to(in.offset); offset != e->offset)
        accessors[a]["byteOffset"] = offset;
      std::size_t stride = e->stride;
      for (std::size_t i = 1; i < e->count; ++i) {
        const std::size_t step = to(begin + i * e->stride) - to(begin + (i - 1) * e->stride);
        if (i > 1 && step != stride) return false;
        stride = step;
      }
      if (stride < e->size) return false;  // elements that overlap
      if (in.stride == 0) {
        if (e->count > 1 && stride != e->stride) return false;
      } else if (e->count > 1) {
        if (strides[e->view] != 0 && strides[e->view] != stride) return false;
        strides[e->view] = stride;
      }
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (gone_views_[v]) continue;
      const View old = view(v);
      const std::size_t offset = moved(old.buffer, old.offset);
      const std::size_t length = moved(old.buffer, old.offset + old.length) - offset;
      if (offset != old.offset) views[v]["byteOffset"] = offset;
      if (length != old.length) views[v]["byteLength"] = length;
      if (strides[v] != 0 && strides[v] != old.stride) views[v]["byteStride"] = strides[v];
    }
    json_["accessors"] = std::move(accessors);
    if (json_.contains("bufferViews")) json_["bufferViews"] = std::move(views);
    return true;
  }

  std::size_t shrink(std::size_t b) {
    if (!file_.buffers[b]) return 0;
    std::string bytes = file_.buffers[b]->joined();
    const std::size_t before = bytes.size(), stated = json_["buffers"][b]["byteLength"].get<std::size_t>();
    std::size_t next = 0;
    for (std::size_t i = 0; i < before; ++i)
      if (!gone_[b][i / 4]) bytes[next++] = bytes[i];
    if (next == before) return 0;
    bytes.resize(next);
    json_["buffers"][b]["byteLength"] = moved(b, std::min(stated, before));
    if (b > 0) json_["buffers"][b]["uri"] = io::make_data_uri("application/octet-stream", bytes);
    file_.buffers[b] = std::move(bytes);
    return before - next;
  }

  GltfFile& file_;
  Json& json_;
  std::vector<bool> gone_accessors_, gone_views_;
  std::vector<std::vector<bool>> gone_;                  // of each buffer, its words
  std::vector<std::vector<std::uint32_t>> kept_before_;  // how many words before each stay
};

// Removes the tangents of idle primitives, and returns the accessors that only these used.
std::set<std::size_t> take_off_idle(GltfFile& file, const TangentNeeds& needs, DroppedIdle& result) {
  std::set<std::size_t> accessors;
  const auto take_off = [&](Json& owner) {
    const auto found = owner.find("TANGENT");
    if (found == owner.end()) return;
    accessors.insert(found->get<std::size_t>());
    owner.erase("TANGENT");
  };
  for (const PrimitiveNeed& p : needs.primitives) {
    if (p.need != TangentNeed::idle) continue;
    Json& primitive = file.json["meshes"][p.mesh]["primitives"][p.primitive];
    // A morph target must not be empty: one with tangents only leaves the primitive unchanged.
    bool alone = false;
    each_of(primitive, "targets",
            [&](Json& target) { alone = alone || (target.size() == 1 && target.contains("TANGENT")); });
    if (alone) continue;
    take_off(primitive["attributes"]);
    each_of(primitive, "targets", take_off);
    result.primitives.push_back({p.mesh, p.primitive,
                                 p.reasons.empty() ? "nothing reads its tangents"
                                                   : "has no normals, so viewers ignore its tangents"});
  }
  each_accessor(file.json,
                [&](Json& number) { accessors.erase(index_below(number, file.json["accessors"].size())); });
  return accessors;
}

// The reason why accessors cannot be renumbered; empty if they can.
std::string obstacle(const GltfFile& file) {
  if (!file.root().has("extensionsUsed")) return "";
  const JsonCursor used = file.root().at("extensionsUsed");
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!names_no_data(used.at(i).text()))
      return "extension " + io::in_quotes(used.at(i).text()) + " may name accessors by number";
  return "";
}

}  // namespace

DroppedIdle drop_idle_tangents(GltfDocument& document) {
  GltfFile& file = document.file();
  const TangentNeeds needs = tangent_need(document);
  const Json before = file.json;
  DroppedIdle result;
  try {
    const std::set<std::size_t> accessors = take_off_idle(file, needs, result);
    if (accessors.empty()) return result;
    result.bytes_kept = obstacle(file);
    if (result.bytes_kept.empty() && !Compaction(file, accessors).run(result.bytes))
      result.bytes_kept = "other attributes overlap them";
    return result;
  } catch (const NoEntry&) {
    file.json = before;
    throw FileError(file.path, expected_got("numbers of accessors and bufferViews that are there", "others"));
  } catch (...) {
    file.json = before;
    throw;
  }
}

}  // namespace darboux
