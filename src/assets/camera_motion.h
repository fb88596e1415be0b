/// \file camera_motion.h
/// Animated cameras of glTF files.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/scene.h>

#include "io/gltf_file.h"

namespace darboux {

/// The path of a camera under the first animation that moves it or one of its ancestors: translations,
/// rotations and scales of nodes, at linear, step and cubic keys as glTF has them. The projection does not
/// change.
class CameraMotion {
 public:
  /// The first shown node that has a camera and that keys of translations, rotations or scales move: its own
  /// keys or an ancestor's. Cost: linear in nodes and channels
  static std::optional<std::size_t> first_moved(const GltfFile& file,
                                                const std::vector<io::ShownNode>& shown);

  /// \param at of first_moved() \param camera its, at rest
  /// \throws FileError for inconsistent keys
  static CameraMotion of(const GltfFile& file, const std::vector<io::ShownNode>& shown, std::size_t at,
                         const Camera& camera);

  /// The camera at a fraction of the time from the first key to the last, 0 to 1.
  Camera at(double share) const;

 private:
  enum class Interpolation { linear, step, cubic };
  struct Channel {
    Interpolation interpolation;
    std::vector<double> times, values;  // of cubic keys: tangent before, value, tangent behind

    Eigen::Vector4d at(double time, std::size_t components) const;
  };
  struct Node {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();  // of one without the others
    Eigen::Vector4d translation{0, 0, 0, 0}, rotation{0, 0, 0, 1}, scale{1, 1, 1, 0};
    std::optional<Channel> translations{}, rotations{}, scales{};

    Eigen::Matrix4d at(double time) const;
  };
  static Channel read_channel(const GltfFile& file, const io::JsonCursor& sampler, std::size_t components);

  Camera camera_;
  std::vector<Node> nodes_;  // from the root to that of the camera
  double from_ = 0, to_ = 0;
};

}  // namespace darboux
