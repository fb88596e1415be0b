/// \file tangent_makers.h
/// Makers of tangents, each measured alone in a process of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace darboux::bench {

/// What a process tells of the maker that it ran.
struct Sample {
  double seconds;  ///< a call, when it has been called before: of the processor, the clock's for threads
  double first_seconds;  ///< the first call
  double bytes;          ///< at the peak of the first call, beyond input and output
};

/// Runs a maker in C++ on a file's triangles: "darboux-1" and "darboux-2", mikktspace() with so many threads,
/// "darboux-kept", one thread with memory that is kept from call to call, or "assimp". mesh_tangents.mjs is
/// the same for makers of npm. \param tangents where not empty, the file that x, y, z of the tangent and the
/// raw sign of each corner go to \throws std::runtime_error
Sample measure_maker(const std::string& maker, const std::filesystem::path& mesh,
                     const std::filesystem::path& tangents);

}  // namespace darboux::bench
