// The extension of a file name.
#pragma once

#include <filesystem>
#include <string>

#include "text.h"

namespace darboux {

/// In lower case, with its dot: ".glb" of "a/Cube.GLB"; empty if there is none.
inline std::string extension_of(const std::filesystem::path& path) {
  return lower(path.extension().string());
}

}  // namespace darboux
