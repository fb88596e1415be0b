#include "camera_motion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "io/accessor.h"

namespace darboux {
namespace {

using io::JsonCursor;

// Nodes of a file, from a root to a shown one.
std::vector<std::size_t> nodes_above(const std::vector<io::ShownNode>& shown, std::size_t at) {
  std::vector<std::size_t> result{shown[at].node};
  for (; shown[at].parent != at; at = shown[at].parent) result.push_back(shown[shown[at].parent].node);
  std::reverse(result.begin(), result.end());
  return result;
}

// Calls f(channel, node, path) for the channels of an animation that move nodes.
template <class F>
void for_each_move(const JsonCursor& animation, F&& f) {
  const JsonCursor channels = animation.at("channels");
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const JsonCursor channel = channels.at(c), target = channel.at("target");
    if (!target.has("node")) continue;
    const std::string path = target.at("path").text();
    if (path == "translation" || path == "rotation" || path == "scale")
      f(channel, target.at("node").integer(), path);
  }
}

std::vector<double> numbers_of(const GltfFile& file, const JsonCursor& index, std::size_t components) {
  const io::Accessor accessor = io::read_accessor(file, index);
  if (accessor.components != components)
    index.fail("an accessor of " + std::to_string(components) + " components", accessor.type);
  std::vector<double> values(accessor.count * components);
  io::numbers(accessor, values);
  if (!std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }))
    index.fail("finite numbers", "others");
  return values;
}

}  // namespace

CameraMotion::Channel CameraMotion::read_channel(const GltfFile& file, const JsonCursor& sampler,
                                                 std::size_t components) {
  Channel channel{Interpolation::linear, numbers_of(file, sampler.at("input"), 1),
                  numbers_of(file, sampler.at("output"), components)};
  if (sampler.has("interpolation")) {
    const std::string name = sampler.at("interpolation").text();
    if (name == "STEP")
      channel.interpolation = Interpolation::step;
    else if (name == "CUBICSPLINE")
      channel.interpolation = Interpolation::cubic;
    else if (name != "LINEAR")
      sampler.at("interpolation").fail("LINEAR, STEP or CUBICSPLINE", "'" + name + "'");
  }
  const std::size_t keys = channel.times.size(),
                    values = keys * components * (channel.interpolation == Interpolation::cubic ? 3 : 1);
  if (keys == 0 || std::adjacent_find(channel.times.begin(), channel.times.end(), std::greater_equal()) !=
                       channel.times.end())
    sampler.at("input").fail("times that rise", keys == 0 ? "none" : "others");
  if (channel.values.size() != values)
    sampler.at("output").fail(std::to_string(values / components) + " elements for these keys",
                              std::to_string(channel.values.size() / components));
  return channel;
}

Eigen::Vector4d CameraMotion::Channel::at(double time, std::size_t components) const {
  const bool cubic = interpolation == Interpolation::cubic, rotates = components == 4;
  const auto value = [&](std::size_t key, std::size_t part) {
    Eigen::Vector4d x = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < components; ++i)
      x[static_cast<Eigen::Index>(i)] = values[(cubic ? 3 * key + part : key) * components + i];
    return x;
  };
  const auto next =
      static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  if (next == 0) return value(0, 1);
  const std::size_t last = next - 1;
  if (next == times.size() || interpolation == Interpolation::step) return value(last, 1);
  const double step = times[next] - times[last], s = (time - times[last]) / step;
  const Eigen::Vector4d a = value(last, 1), b = value(next, 1);
  if (!cubic && rotates)
    return Eigen::Quaterniond(a).normalized().slerp(s, Eigen::Quaterniond(b).normalized()).coeffs();
  if (!cubic) return (1 - s) * a + s * b;
  const double s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * a + step * (s3 - 2 * s2 + s) * value(last, 2) + (3 * s2 - 2 * s3) * b +
         step * (s3 - s2) * value(next, 0);
}

Eigen::Matrix4d CameraMotion::Node::at(double time) const {
  const Eigen::Vector4d t = translations ? translations->at(time, 3) : translation,
                        r = rotations ? rotations->at(time, 4) : rotation,
                        s = scales ? scales->at(time, 3) : scale;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.translate(t.head<3>());
  transform.rotate(Eigen::Quaterniond(r).normalized());
  transform.scale(s.head<3>());
  return transform.matrix() * matrix;
}

Camera CameraMotion::at(double share) const {
  const double time = from_ + share * (to_ - from_);
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
  for (const Node& node : nodes_) world *= node.at(time);
  Camera camera = camera_;
  camera.pose.linear() = world.topLeftCorner<3, 3>().colwise().normalized();
  camera.pose.translation() = world.topRightCorner<3, 1>();
  return camera;
}

std::optional<std::size_t> CameraMotion::first_moved(const GltfFile& file,
                                                     const std::vector<io::ShownNode>& shown) {
  const JsonCursor root = file.root();
  if (!root.has("animations") || !root.has("nodes")) return std::nullopt;
  const JsonCursor nodes = root.at("nodes"), animations = root.at("animations");
  std::vector<bool> has_keys(nodes.size(), false);
  for (std::size_t a = 0; a < animations.size(); ++a)
    for_each_move(animations.at(a), [&](const JsonCursor&, std::uint64_t node, const std::string&) {
      if (node < has_keys.size()) has_keys[node] = true;
    });
  std::vector<bool> moved(shown.size(), false);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    moved[i] = has_keys[shown[i].node] || moved[shown[i].parent];
    if (moved[i] && nodes.at(shown[i].node).has("camera")) return i;
  }
  return std::nullopt;
}

CameraMotion CameraMotion::of(const GltfFile& file, const std::vector<io::ShownNode>& shown, std::size_t at,
                              const Camera& camera) {
  const JsonCursor root = file.root(), nodes = root.at("nodes"), animations = root.at("animations");
  const std::vector<std::size_t> chain = nodes_above(shown, at);
  std::vector<std::size_t> place(nodes.size(), chain.size());
  for (std::size_t i = 0; i < chain.size(); ++i) place[chain[i]] = i;
  CameraMotion motion;
  motion.camera_ = camera;
  for (const std::size_t i : chain) {
    Node& here = motion.nodes_.emplace_back();
    const JsonCursor stored = nodes.at(i);
    const auto read = [&](const char* key, Eigen::Vector4d& x) {
      if (!stored.has(key)) return;
      for (std::size_t k = 0; k < stored.at(key).size() && k < 4; ++k)
        x[static_cast<Eigen::Index>(k)] = stored.at(key).at(k).number();
    };
    read("translation", here.translation);
    read("rotation", here.rotation);
    read("scale", here.scale);
    if (stored.has("matrix"))
      for (std::size_t k = 0; k < 16 && k < stored.at("matrix").size(); ++k)
        here.matrix(static_cast<Eigen::Index>(k % 4), static_cast<Eigen::Index>(k / 4)) =
            stored.at("matrix").at(k).number();
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  motion.from_ = infinity;
  motion.to_ = -infinity;
  for (std::size_t a = 0; a < animations.size() && !(motion.from_ <= motion.to_); ++a) {
    for_each_move(
        animations.at(a), [&](const JsonCursor& channel, std::uint64_t node, const std::string& path) {
          if (node >= place.size() || place[node] == chain.size()) return;
          const JsonCursor samplers = animations.at(a).at("samplers");
          if (channel.at("sampler").integer() >= samplers.size())
            channel.at("sampler").fail("one of the samplers of its animation", "another");
          Channel read =
              read_channel(file, samplers.at(channel.at("sampler").integer()), path == "rotation" ? 4 : 3);
          motion.from_ = std::min(motion.from_, read.times.front());
          motion.to_ = std::max(motion.to_, read.times.back());
          Node& moved = motion.nodes_[place[node]];
          (path == "translation" ? moved.translations
           : path == "rotation"  ? moved.rotations
                                 : moved.scales) = std::move(read);
        });
  }
  return motion;
}

}  // namespace darboux
