/// \file validate_pictures.h
/// Pictures of the results of validate: a mesh coloured by error, and an HTML page.
#pragma once

#include <string>
#include <vector>

#include "validate_files.h"

namespace darboux {

/// The requested output files; empty if not requested.
struct Pictures {
  std::string paint, page;
  bool any() const { return !paint.empty() || !page.empty(); }
};

/// Adds --paint and --report to a subcommand.
void add_pictures(CLI::App& sub, Pictures& pictures);

/// Checks the outputs before any file is read. \throws ParameterError if one cannot be written
void check_pictures(const Pictures& pictures, std::size_t files);

/// Writes the pictures. The assessments must keep errors, and the primitives must have their data.
/// \throws FileError, MeshError
void write_pictures(const Pictures& pictures, const std::vector<AssessedFile>& files, double max_angle_deg,
                    const ReadOptions& read);

/// The error at each vertex: the largest of its corners; NaN if none was compared.
std::vector<float> vertex_errors(const AssessedPrimitive& assessed);

}  // namespace darboux
