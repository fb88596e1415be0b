/// \file files.h
/// Reads whole files, and the URIs by which glTF refers to them.
#pragma once

#include <string>
#include <string_view>

#include <darboux/error.h>

#include "buffer_bytes.h"

namespace darboux {
struct ReadOptions;
}

namespace darboux::io {

/// \throws FileError if the path does not exist, or is a folder, device or pipe
void expect_regular_file(const std::string& path);

/// The bytes of a regular file. \throws FileError
std::string read_file(const std::string& path);

/// The same bytes, memory-mapped if the system supports it, hence not copied. The file must not be modified
/// while mapped: bytes that were checked may change, and reading bytes that were truncated or are unreadable
/// kills the process (SIGBUS). Replacing the file by rename, as OutputFile does, is harmless. \throws
/// FileError
Piece map_file(const std::string& path);

/// Whether a regular file is a glTF by its content ("glTF") or its extension. \throws FileError
bool is_gltf(const std::string& path);

/// Text from a file or user for a one-line message: quoted, on one line, shortened.
std::string in_quotes(std::string_view text);

/// Whether a URI begins "data:".
bool is_data_uri(std::string_view uri);

/// A document refers to a file outside its folder, which is not permitted.
class OutsideError : public FileError {
  using FileError::FileError;
};

/// The path to which a URI refers, relative to the folder of `base`; empty for a data URI. Does not check
/// whether it may be read.
std::string file_of_uri(const std::string& base, const std::string& uri);

/// The bytes to which a URI refers: those of a base64 data URI, or of a file relative to the folder of
/// `base`. \param name the name of the URI in messages
/// \throws FileError with the subject `base`, on absolute paths, other schemes and broken base64
/// \throws OutsideError for an existing file outside that folder and its subfolders
std::string load_uri(const std::string& base, const std::string& name, const std::string& uri,
                     const ReadOptions& options);

/// data:MEDIA_TYPE;base64,...
std::string make_data_uri(std::string_view media_type, std::string_view bytes);

}  // namespace darboux::io
