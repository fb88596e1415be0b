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
  double max_angle_deg = 1;  // over the rounding of two maps, 8 bits in each of 3 channels: 0.78
  std::uint64_t worst = 10;
};

/// What a map alone tells; status 1 where something is wrong with it.
void run_map_check(const MapCheckArguments& arguments, Common& common);

/// How far two maps are apart; status 1 where that is more than asked for. \param mesh the triangles that
/// count, with its options
void run_map_comparison(const MapCheckArguments& arguments, const MapArguments& mesh, bool drop_colour_tags,
                        Common& common);

}  // namespace darboux
