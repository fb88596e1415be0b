// Which folder or header may include which. Arrows run one way.
#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace darboux::test {
namespace {

constexpr const char* standard = "[a-z_0-9]+";

// A file whose path matches `in` may include only what matches `only`, or nothing that matches `never`.
struct Rule {
  std::string why, in;
  std::string only, never;
};

// The names of the headers in surfaces/, as a pattern.
std::string surface_headers(const Includes& tree) {
  std::string names;
  for (const auto& [path, includes] : tree)
    if (path.starts_with("surfaces/")) names += (names.empty() ? "" : "|") + path.substr(9);
  return names;
}

std::vector<Rule> rules(const Includes& tree) {
  const std::string surfaces = surface_headers(tree);
  const std::string mesh_core =
      "(mesh|mesh_frames|mesh_frames/[a-z_]+|fragments|vertex_normals|mesh_classes|mikktspace|mikktspace/"
      "[a-z_]+|split_vertices|weld|compare)";
  return {
      {"a surface knows no engine", "surfaces/darboux/(?!catalogue\\.h).*",
       std::string(standard) + "|darboux/(surface|scalar|vector|curve|spline)\\.h", ""},
      {"the catalogue only lists", "surfaces/darboux/catalogue\\.h", surfaces, ""},
      {"the engine knows no particular surface", "include/.*", "", surfaces},
      {"binary, error and attributes stand below everything", "include/darboux/(binary|error|attributes)\\.h",
       standard, ""},
      {"scalar stands on elementary, that on binary", "include/darboux/(scalar|elementary)\\.h",
       std::string(standard) + "|darboux/(binary|elementary)\\.h", ""},
      {"vector and many_digits stand on scalar", "include/darboux/(vector|many_digits)\\.h",
       std::string(standard) + "|Eigen/.*|darboux/scalar\\.h", ""},
      {"curves know no engine", "include/darboux/(curve|spline)\\.h",
       std::string(standard) + "|darboux/(scalar|vector|surface|spline|error)\\.h", ""},
      {"boost stays behind many_digits", "(?!src/many_digits\\.cpp|tests/).*", "", "boost/.*"},
      {"the core knows no files, no fit and no verdict",
       "(include/darboux|src)/"
       "(any_surface|testing|evaluate|point|limit|forms|frame|differentiate|adaptors|mesh|mesh_frames|mesh_"
       "frames/[a-z_]+|fragments|vertex_normals|pieces|"
       "mesh_classes|mikktspace|mikktspace/"
       "[a-z_]+|split_vertices|weld|sample_mesh|sample_mesh/"
       "[a-z_]+|compare|converge|placed_surface|project|validate|validate/"
       "[a-z_]+|point_cloud|local_jets|local_truth|"
       "neighbours)\\.(h|"
       "cpp)",
       "", "darboux/(io|fit|judge)\\.h"},
      {"surface.h stands on scalar and vector", "include/darboux/surface\\.h",
       std::string(standard) + "|darboux/(scalar|vector)\\.h", ""},
      {"frame, limit, point, forms, differentiate, evaluate stand on surface.h and each other",
       "include/darboux/(frame|limit|point|forms|differentiate|evaluate|blocks)\\.h",
       std::string(standard) +
           "|Eigen/.*|darboux/"
           "(scalar|vector|surface|attributes|frame|limit|point|forms|differentiate|evaluate)\\.h",
       ""},
      {"xsimd stays in the kernels", "(?!src/kernels/|tests/).*", "", "xsimd/.*"},
      {"threads stay behind these", "(?!src/evaluate\\.cpp|src/pieces\\.h|tests/).*", "", "tbb/.*"},
      {"local jets know no parametric surface and no mesh",
       "(include/darboux|src)/(point_cloud|local_jets|local_jets/[a-z_]+|neighbours)\\.(h|cpp)",
       std::string(standard) +
           "|Eigen/.*|nanoflann\\.hpp|darboux/"
           "(elementary|vector|surface|frame|forms|evaluate|point_cloud|local_jets|error)\\.h|(neighbours|"
           "pieces|"
           "(local_jets/)?(batch|uv_fit|least_squares)|(\\.\\./)?kernels/(dispatch|uv_jets))\\.h",
       ""},
      {"nanoflann stays behind neighbours.h", "(?!src/neighbours\\.h|tests/).*", "", "nanoflann\\.hpp"},
      {"a mesh knows no parametric surface", "(include/darboux|src)/" + mesh_core + "\\.(h|cpp)",
       std::string(standard) + "|Eigen/.*|darboux/(scalar|vector|surface|frame|error)\\.h|darboux/" +
           mesh_core +
           "\\.h|darboux/statistics\\.h|disjoint_sets\\.h|tbb/.*|sys/"
           "mman\\.h|(arithmetic|buffer|connectivity|creases|input|rings|triangle|(\\.\\./)?"
           "(pieces|text|edges|hash_table|triangle_signs))\\.h",
       ""},
      {"public headers show Eigen and the standard library only", "(include|surfaces)/.*",
       std::string(standard) + "|Eigen/.*|darboux/.*", ""},
      {"nothing includes the command line or the report", "(?!src/(cli|report)/|tests/).*", "",
       "(\\.\\./|src/)*(cli|report)/.*"},
      {"Ceres stays behind the fit", "(?!src/fit\\.cpp|src/fit/|tests/).*", "", "ceres/.*|glog/.*"},
      {"the fits of points stand side by side on what they share, only points.cpp chooses",
       "src/fit/(?!points\\.cpp).*", "", "(\\.\\./)?(any_kind|by_kind|with_uv)/.*"},
      {"the file libraries stay behind io, JSON also in the tool", "(?!src/(io|cli|report)/|tests/).*", "",
       "nlohmann/.*|assimp/.*|tiny_gltf\\.h"},
      {"assimp stays behind io", "(?!src/io/|tests/).*", "", "assimp/.*|tiny_gltf\\.h"},
      {"CLI11 stays in the command line", "(?!src/cli/).*", "", "CLI/.*"},
      {"only these know all surfaces",
       "(?!src/any_surface\\.cpp|src/fit\\.cpp|src/(fit|kernels|cli)/|tests/).*", "",
       "darboux/catalogue\\.h"},
      {"the library needs no test framework", "(include|surfaces|src)/.*", "", "gtest/.*|gmock/.*"},
  };
}

std::vector<std::string> violations(const Includes& tree) {
  std::vector<std::string> result;
  for (const Rule& rule : rules(tree)) {
    const std::regex in(rule.in), only(rule.only), never(rule.never);
    for (const auto& [path, includes] : tree) {
      if (!std::regex_match(path, in)) continue;
      for (const std::string& name : includes)
        if ((!rule.only.empty() && !std::regex_match(name, only)) ||
            (!rule.never.empty() && std::regex_match(name, never)))
          result.push_back(path + " includes " + name + ": " + rule.why);
    }
  }
  return result;
}

TEST(Arrows, RunOneWay) {
  const Includes tree = includes_below({"include", "surfaces", "src"});
  EXPECT_GT(tree.size(), 15U) << "the tree was not found at " << DARBOUX_SOURCE;
  EXPECT_TRUE(tree.contains("include/darboux/frame.h"));
  for (const std::string& violation : violations(tree)) ADD_FAILURE() << violation;
}

// A tree in order, to put one bad include into.
Includes good_tree() {
  return {{"surfaces/darboux/torus.h", {"array", "darboux/surface.h"}},
          {"surfaces/darboux/catalogue.h", {"darboux/torus.h"}},
          {"include/darboux/frame.h", {"cmath", "Eigen/Geometry", "darboux/surface.h"}},
          {"include/darboux/mesh.h", {"vector", "darboux/vector.h"}},
          {"src/any_surface.cpp", {"darboux/catalogue.h"}},
          {"src/fit.cpp", {"ceres/ceres.h", "darboux/catalogue.h"}},
          {"src/fit/points.cpp", {"by_kind/by_kind.h", "with_uv/with_uv.h"}},
          {"src/io/gltf.cpp", {"nlohmann/json.hpp", "assimp/scene.h", "accessor.h"}},
          {"src/cli/main.cpp", {"CLI/CLI.hpp", "report/page.h", "darboux/catalogue.h", "nlohmann/json.hpp"}}};
}

TEST(Arrows, ATreeInOrderHasNoViolation) {
  EXPECT_EQ(violations(good_tree()), std::vector<std::string>{});
}

TEST(Arrows, EveryWrongArrowIsFound) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"surfaces/darboux/torus.h", "darboux/frame.h"},
      {"surfaces/darboux/torus.h", "Eigen/Core"},
      {"surfaces/darboux/catalogue.h", "darboux/any_surface.h"},
      {"include/darboux/frame.h", "darboux/torus.h"},
      {"include/darboux/frame.h", "darboux/any_surface.h"},
      {"include/darboux/evaluate.h", "darboux/mesh.h"},
      {"include/darboux/surface.h", "darboux/frame.h"},
      {"include/darboux/scalar.h", "darboux/surface.h"},
      {"include/darboux/vector.h", "darboux/surface.h"},
      {"include/darboux/curve.h", "darboux/frame.h"},
      {"include/darboux/testing.h", "boost/multiprecision/cpp_bin_float.hpp"},
      {"src/validate.cpp", "darboux/fit.h"},
      {"src/compare.cpp", "darboux/io.h"},
      {"include/darboux/compare.h", "darboux/any_surface.h"},
      {"src/fit/by_kind/starts.cpp", "nanoflann.hpp"},
      {"src/fit/by_kind/choose.cpp", "../any_kind/any_kind.h"},
      {"src/fit/kinds.h", "with_uv/kinds.h"},
      {"src/local_jets.cpp", "darboux/torus.h"},
      {"include/darboux/local_jets.h", "darboux/mesh.h"},
      {"include/darboux/mesh.h", "darboux/evaluate.h"},
      {"include/darboux/mesh_frames.h", "darboux/torus.h"},
      {"include/darboux/weld.h", "darboux/any_surface.h"},
      {"src/mesh_frames/averages.cpp", "darboux/evaluate.h"},
      {"include/darboux/scalar.h", "darboux/vector.h"},
      {"include/darboux/evaluate.h", "xsimd/xsimd.hpp"},
      {"src/validate.cpp", "tbb/parallel_for.h"},
      {"include/darboux/fit.h", "ceres/ceres.h"},
      {"include/darboux/io.h", "nlohmann/json.hpp"},
      {"include/darboux/io.h", "assimp/scene.h"},
      {"include/darboux/scene.h", "CLI/CLI.hpp"},
      {"include/darboux/testing.h", "gtest/gtest.h"},
      {"src/validate.cpp", "ceres/ceres.h"},
      {"src/validate.cpp", "darboux/catalogue.h"},
      {"src/validate.cpp", "nlohmann/json.hpp"},
      {"src/validate.cpp", "cli/table.h"},
      {"src/io/gltf.cpp", "../report/page.h"},
      {"src/cli/main.cpp", "assimp/scene.h"},
      {"src/report/page.cpp", "CLI/CLI.hpp"},
      {"src/report/page.cpp", "darboux/catalogue.h"},
  };
  for (const auto& [path, name] : wrong) {
    Includes tree = good_tree();
    tree[path].push_back(name);
    EXPECT_FALSE(violations(tree).empty()) << path << " may include " << name;
  }
}

TEST(IncludedBy, ReadsDirectivesOnly) {
  EXPECT_EQ(
      included_by(
          "#include <cmath>\n  #  include \"a/b.h\"\n// #include <no>\nconst char* s = \"#include <no>\";\n"),
      (std::vector<std::string>{"cmath", "a/b.h"}));
}

}  // namespace
}  // namespace darboux::test
