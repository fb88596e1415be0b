// What an assessment says of a mesh, in short, and a map that changes its positions alone.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <darboux/assess.h>
#include <darboux/vector.h>

namespace darboux::test {

using Codes = std::set<std::string>;

// Of severity error or warning.
inline Codes codes(const std::vector<Assessment>& assessments) {
  Codes result;
  for (const Assessment& j : assessments)
    for (const Finding& f : j.report.findings)
      if (f.severity != Severity::info) result.insert(std::string(f.code));
  return result;
}

inline std::string joined(const Codes& codes) {
  std::string text;
  for (const std::string& code : codes) text += code + ' ';
  return text;
}

// Normals and tangents stay as they are.
inline void turn_by(Mesh& mesh, const Eigen::Matrix3d& m) {
  for (auto& p : mesh.positions) p = from_eigen(Eigen::Vector3d(m * to_eigen(p)));
}

}  // namespace darboux::test
