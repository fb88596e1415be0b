/// \file collada.h
/// A COLLADA document, and how a message names a place in it.
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

  /// The element that an attribute names as "#id", null where there is none.
  pugi::xml_node find(const pugi::xml_node& at, const char* attribute) const;

  /// The same. \param kind its name \throws FileError where there is none
  pugi::xml_node target(const pugi::xml_node& at, const char* attribute, const char* kind) const;

  /// A whole number in an attribute. \throws FileError where it is none
  std::uint64_t count(const pugi::xml_node& at, const char* attribute, std::uint64_t fallback) const;

  /// The numbers that an element's text is. \throws FileError where something else stands there
  std::vector<double> numbers(const pugi::xml_node& at) const;
  std::vector<std::uint64_t> indices(const pugi::xml_node& at) const;

  /// The numbers of a <float_array>, read once. \throws FileError where they are not as many as it states
  const std::vector<double>& array(const pugi::xml_node& at) const;

 private:
  std::string path_;
  pugi::xml_document document_;
  std::unordered_map<std::string_view, pugi::xml_node> ids_;  // the first of each id
  mutable std::unordered_map<const void*, std::vector<double>> arrays_;
};

/// An element, for messages.
struct ColladaPlace {
  const Collada& file;
  const pugi::xml_node& element;
  [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
    file.fail(element, expected, got);
  }
};

/// The groups of polygons of a <geometry>, one primitive each, and what was passed over. \param number of the
/// geometry \param instances of each of them
void read_geometry(const Collada& file, const pugi::xml_node& geometry, std::size_t number,
                   const Instances& instances, Budget& budget, Asset& asset);

/// World matrices of the nodes that show each of these. \throws FileError
std::vector<std::vector<Eigen::Matrix4d>> read_instances(const Collada& file,
                                                         const std::vector<pugi::xml_node>& geometries);

}  // namespace darboux::io
