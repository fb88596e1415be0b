/// \file refused_files.h
/// Files that must be refused, and how: by a FileError of one line that names the file, what is wrong and
/// what was expected.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "io/gltf_file.h"
#include "io_files.h"

namespace darboux::test {

inline void check_message(const std::string& message, const std::string& path, const std::string& part) {
  EXPECT_TRUE(message.starts_with(path.empty() ? "\"\":" : path + ":")) << message;  // or its line
  EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
  EXPECT_NE(message.find("expected "), std::string::npos) << message;
  EXPECT_NE(message.find(", got "), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LE(message.size(), 480u) << message;
}

/// Reads a file that must be refused, and checks the form of the message.
inline void expect_refused(const std::string& path, const std::string& part) {
  SCOPED_TRACE(path);
  try {
    read_asset(path);
    ADD_FAILURE() << "was read, expected an error with: " << part;
  } catch (const FileError& error) {
    check_message(error.what(), path, part);
  }
}

/// Reads a glTF's content from memory; false when it was refused, by a proper message.
inline bool content_is_read(const std::string& bytes) {
  const std::string path = "memory.glb";
  try {
    for (const Primitive& p : io::read_gltf(io::load_gltf(path, io::Piece::of(bytes))).primitives)
      check_consistent(p.data, path);
    return true;
  } catch (const FileError& error) {
    check_message(error.what(), path, "");
    return false;
  }
}

inline void expect_bytes_refused(const std::string& bytes, const std::string& part,
                                 const std::string& name = "bad.glb") {
  const TempFolder folder;
  expect_refused(write_bytes(folder / name, bytes), part);
}

}  // namespace darboux::test
