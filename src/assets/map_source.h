/// \file map_source.h
/// The source of a normal map, and the memory it requires.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <darboux/image.h>
#include <darboux/io.h>
#include <darboux/normal_map_files.h>

namespace darboux {

/// Primitives of a file, by number: MapPieceOptions::only.
using ChosenPrimitives = decltype(MapPieceOptions::only);

/// The bytes of a map: of an image file, or of the one image that the normal textures of a glTF have.
struct MapSource {
  std::string name, bytes;
  std::string file{};             ///< that holds the image, where a glTF names one
  ChosenPrimitives primitives{};  ///< of a glTF: those that have it
};

/// \param only for glTF, the primitives to use; all if the list is empty. No value: the caller has no option
/// --primitive, and no message mentions it
/// \throws FileError if a glTF has no normal texture, or several
MapSource map_source(const std::string& path, const std::optional<ChosenPrimitives>& only,
                     const ReadOptions& options);

/// Checks the memory that convert_normal_map() takes for its result against ReadOptions::max_memory.
/// \param there bytes of its input \param texels of the result, with so many channels of a type
/// \throws FileError
void check_map_memory(const std::string& file, std::uint64_t there, std::uint64_t texels, int channels,
                      SampleType type, const ReadOptions& options);

}  // namespace darboux
