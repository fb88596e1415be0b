/// \file validate_pictures.h
/// Pictures of what validate found: a mesh painted by error, and a page for people.
#pragma once

#include <string>
#include <vector>

#include "validate_files.h"

namespace darboux {

/// What is asked for; empty where it is not.
struct Pictures {
  std::string paint, page;
  bool any() const { return !paint.empty() || !page.empty(); }
};

/// Adds --paint and --report to a subcommand.
void add_pictures(CLI::App& sub, Pictures& pictures);

/// \throws ParameterError for what cannot be written, before any file is read
void check_pictures(const Pictures& pictures, std::size_t files);

/// Writes them. Of files whose assessments keep errors and whose primitives have their data.
/// \throws FileError, MeshError
void write_pictures(const Pictures& pictures, const std::vector<AssessedFile>& files, double max_angle_deg,
                    const ReadOptions& read);

/// The error at each vertex: the largest at its corners, NaN where none is compared.
std::vector<float> vertex_errors(const AssessedPrimitive& assessed);

}  // namespace darboux
