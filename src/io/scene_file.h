/// \file scene_file.h
/// Scenes of parametric surfaces as JSON: docs/schemas/scene.schema.json.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/scene.h>

namespace darboux::io {

/// A camera of a file, with its name or an empty one.
struct NamedCamera {
  std::string name;
  Camera camera;
};

struct SceneFile {
  Scene scene;
  std::vector<std::string> surface_names;  ///< of its surfaces
  std::vector<NamedCamera> cameras;        ///< at least one
  SceneRequest request;
};

/// Makes a surface from its text in the file: "torus:major_radius=1,minor_radius=0.4".
using MakeSurface = std::function<AnySurface(std::string_view)>;

inline constexpr std::size_t most_scene_instances = 10000000;  // 1.5 GB of memory

/// Reads a scene of at most 128 MiB of JSON and 10^7 instances. Cost: about 20 us for an instance that is
/// listed, 0.2 us for a scattered one. \throws FileError with the file and a JSON pointer, for an unknown
/// key, a value out of range, or a surface that make_surface rejects
SceneFile read_scene_file(
    const std::string& path,
    const MakeSurface& make_surface = [](std::string_view text) { return darboux::make_surface(text); });

}  // namespace darboux::io
