/// \file map_checks.h
/// `normalmap --check` and `normalmap --compare`.
#pragma once

#include <string>
#include <vector>

#include "map_arguments.h"

namespace darboux {

struct MapCheckArguments {
  std::string file, green, report;
  std::vector<std::string> compared;    ///< two files
  std::vector<std::string> primitives;  ///< of `file`, where it is a glTF
  bool signed_floats = false;
  double max_angle_deg = 1;  // above the 0.78 that rounding of two maps with three 8-bit channels can cause
  std::uint64_t worst = 10;
};

/// Checks a map without a mesh. Exit status 1 if there is a finding.
void run_map_check(const MapCheckArguments& arguments, Common& common);

/// Compares two maps. Exit status 1 if they differ by more than the limit. \param mesh the triangles whose
/// texels are compared, with its options
void run_map_comparison(const MapCheckArguments& arguments, const MapArguments& mesh, bool drop_colour_tags,
                        Common& common);

}  // namespace darboux
