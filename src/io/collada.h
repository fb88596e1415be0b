/// \file collada.h
/// A COLLADA document, with error messages that name the element.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

#include <darboux/io.h>

#include "budget.h"

namespace darboux::io {

class Collada {
 public:
  /// \throws FileError
  Collada(const std::string& file, const std::string& bytes);

  pugi::xml_node root() const { return document_.child("COLLADA"); }

  /// \throws FileError "FILE: <source> at byte 120, id "x": expected EXPECTED, got GOT"
  [[noreturn]] void fail(const pugi::xml_node& at, const std::string& expected, const std::string& got) const;

  /// The element to which an attribute refers as "#id"; null if there is none.
  pugi::xml_node find(const pugi::xml_node& at, const char* attribute) const;

  /// The same. \param kind the expected element name \throws FileError if there is none
  pugi::xml_node target(const pugi::xml_node& at, const char* attribute, const char* kind) const;

  /// An unsigned integer attribute. \throws FileError if it is not an integer
  std::uint64_t count(const pugi::xml_node& at, const char* attribute, std::uint64_t fallback) const;

  /// The numbers in the text of an element. \throws FileError if the text contains anything else
  std::vector<double> numbers(const pugi::xml_node& at) const;
  std::vector<std::uint64_t> indices(const pugi::xml_node& at) const;

  /// The numbers of a <float_array>, cached. \throws FileError if their number differs from the stated count
  const std::vector<double>& array(const pugi::xml_node& at) const;

 private:
  std::string path_;
  pugi::xml_document document_;
  std::unordered_map<std::string_view, pugi::xml_node> ids_;  // the first of each id
  mutable std::unordered_map<const void*, std::vector<double>> arrays_;
};

/// An element, for error messages.
struct ColladaPlace {
  const Collada& file;
  const pugi::xml_node& element;
  [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
    file.fail(element, expected, got);
  }
};

/// Reads the polygon groups of a <geometry>, one primitive each, and reports what was skipped. \param number
/// the index of the geometry \param instances the instances of each primitive
void read_geometry(const Collada& file, const pugi::xml_node& geometry, std::size_t number,
                   const Instances& instances, Budget& budget, Asset& asset);

/// World matrices of the nodes that reference each geometry. \throws FileError
std::vector<std::vector<Eigen::Matrix4d>> read_instances(const Collada& file,
                                                         const std::vector<pugi::xml_node>& geometries);

}  // namespace darboux::io
