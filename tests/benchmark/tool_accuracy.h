/// \file tool_accuracy.h
/// How far the tangents that tools make are from the truth, on meshes of surfaces that are known exactly.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/validate.h>

namespace darboux::bench {

/// The meshes that tools/make.mjs writes, and the tools, those that run here last.
std::span<const std::string_view> shapes();
std::span<const std::string_view> tools();

/// What validate() says of one tool's tangents on one mesh of resolution n.
struct ToolReport {
  std::string_view shape, tool;
  int n;
  MeshReport report;
};

/// Corners of a class whose tangent is zero or not finite: they have no angle.
std::size_t without_direction(const ClassReport& report);

/// All tools on all shapes of one resolution, from the folder that tools/make.mjs wrote; runs assimp's.
/// \throws std::runtime_error
std::vector<ToolReport> assess_tools(const std::filesystem::path& folder, int n);

/// x, y, z, w of each corner by one tool, from that folder. \throws std::runtime_error
std::vector<float> tangents_by(std::string_view tool, const std::filesystem::path& folder,
                               std::string_view shape);

}  // namespace darboux::bench
