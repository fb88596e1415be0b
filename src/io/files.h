/// \file files.h
/// Reading whole files, and the URIs by which a glTF names them.
#pragma once

#include <string>
#include <string_view>

#include <darboux/error.h>

#include "buffer_bytes.h"

namespace darboux {
struct ReadOptions;
}

namespace darboux::io {

/// \throws FileError for what does not exist, folders, devices and pipes
void expect_regular_file(const std::string& path);

/// The bytes of a regular file. \throws FileError
std::string read_file(const std::string& path);

/// The same bytes, mapped where the system can: they are not copied. The file must not be modified meanwhile:
/// bytes that were checked may then differ, and reading bytes that are gone or unreadable kills the process
/// (SIGBUS). Replacing the file by another of its name, as OutputFile does, is harmless. \throws FileError
Piece map_file(const std::string& path);

/// Whether a regular file is a glTF by its content ("glTF") or its extension. \throws FileError
bool is_gltf(const std::string& path);

/// Text of the file or the user made fit for a one-line message: quoted, on one line, shortened.
std::string in_quotes(std::string_view text);

/// Whether a URI begins "data:".
bool is_data_uri(std::string_view uri);

/// A document names a file outside of its folder without permission.
class OutsideError : public FileError {
  using FileError::FileError;
};

/// The file that a URI names, from the folder of `base`; empty for a data URI. Whether it may be read is not
/// looked at.
std::string file_of_uri(const std::string& base, const std::string& uri);

/// The bytes a URI stands for: those of a base64 data URI, or of a file relative to the folder of `base`.
/// \param name what a message calls the URI
/// \throws FileError with the subject `base`, on absolute paths, other schemes and broken base64
/// \throws OutsideError for a file that is there, but neither in that folder nor below it
std::string load_uri(const std::string& base, const std::string& name, const std::string& uri,
                     const ReadOptions& options);

/// data:MEDIA_TYPE;base64,...
std::string make_data_uri(std::string_view media_type, std::string_view bytes);

}  // namespace darboux::io
