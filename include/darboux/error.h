/// \file error.h
/// Exceptions of the library. They are thrown at construction, for invalid arguments, for files and on the
/// command line; never for values of u and v, nor for what a user's formula returns there.
#pragma once

#include <stdexcept>
#include <string>

namespace darboux {

/// Base of everything the library throws. what() is one line: "SUBJECT: expected X, got Y" or "SUBJECT: what
/// is wrong: expected X, got Y". It is UTF-8 of at most 480 bytes: a subject of more than 200 bytes, and a
/// line that is too long as a whole, are shortened in the middle ("..."). Control characters and bytes that
/// are not UTF-8 are escaped (\xFF).
class Error : public std::runtime_error {
 public:
  /// \param subject the file, argument or parameter that is at fault
  /// \param message "expected X, got Y"
  Error(const std::string& subject, const std::string& message);
};

/// A parameter of a surface or of an algorithm lies outside its range, or is unknown.
class ParameterError : public Error {
  using Error::Error;
};

/// A file cannot be read, is broken, or cannot be written.
class FileError : public Error {
  using Error::Error;
};

/// Mesh data that an algorithm cannot work with: an index out of range, a missing attribute.
class MeshError : public Error {
  using Error::Error;
};

}  // namespace darboux
