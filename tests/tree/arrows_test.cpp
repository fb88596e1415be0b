// Which folder or header may include which. Arrows run one way: docs/decisions/0014-rooms-as-layers.md.
#include <algorithm>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace darboux::test::arrows_test {
namespace {

// ---- ranks ------------------------------------------------------------------------------------------------

// The folders of src, and surfaces/, lowest first. A file includes only files of its own folder and of
// folders before it.
const std::vector<std::string> ranks{"base",
                                     "surface",
                                     "surfaces",
                                     "mesh",
                                     "mesh/mikktspace",
                                     "mesh/frames",
                                     "evaluate/kernels",
                                     "evaluate",
                                     "any_surface",
                                     "laws",
                                     "mesh/sample",
                                     "local_jets",
                                     "validate",
                                     "fit/common",
                                     "fit/uv",
                                     "fit/primitives",
                                     "fit/catalogue",
                                     "fit",
                                     "assess",
                                     "converge",
                                     "stability",
                                     "work_precision",
                                     "scene",
                                     "normal_map",
                                     "io",
                                     "assets",
                                     "study",
                                     "report",
                                     "cli"};

// The folder of a public header without a .cpp of its name.
const std::map<std::string, std::string> folder_of_header{{"attributes", "base"},
                                                          {"binary", "base"},
                                                          {"ceres_jet", "fit/common"},
                                                          {"elementary", "base"},
                                                          {"scalar", "base"},
                                                          {"vector", "base"},
                                                          {"adaptor", "surface"},
                                                          {"affine_map", "surface"},
                                                          {"curve", "surface"},
                                                          {"framed_curve", "surface"},
                                                          {"differentiate", "surface"},
                                                          {"derivative", "surface"},
                                                          {"forms", "surface"},
                                                          {"shape_operator", "surface"},
                                                          {"curvature", "surface"},
                                                          {"surface", "surface"},
                                                          {"christoffel", "surface"},
                                                          {"darboux_frame", "surface"},
                                                          {"frame", "surface"},
                                                          {"from_position", "surface"},
                                                          {"limit", "surface"},
                                                          {"offset", "surface"},
                                                          {"placed", "surface"},
                                                          {"point", "surface"},
                                                          {"reparametrised", "surface"},
                                                          {"spline", "surface"},
                                                          {"spline_patch", "surface"},
                                                          {"blocks", "evaluate"},
                                                          {"mesh_frames", "mesh/frames"},
                                                          {"point_cloud", "base"},
                                                          {"fit_points", "fit/common"},
                                                          {"fit_mesh", "fit/common"},
                                                          {"scene", "scene"},
                                                          {"io", "io"},
                                                          {"image", "base"}};

// The folder of a file, empty where it is in none. `tree` tells which .cpp serves a public header.
std::string folder_of(const std::string& path, const Includes& tree) {
  if (path.starts_with("surfaces/darboux/")) return "surfaces";
  if (path.starts_with("src/")) {
    const std::size_t slash = path.rfind('/');
    return slash < 4 ? "" : path.substr(4, slash - 4);
  }
  const std::string prefix = "include/darboux/";
  if (!path.starts_with(prefix)) return "";
  const std::string stem = path.substr(prefix.size(), path.size() - prefix.size() - 2);
  if (const auto listed = folder_of_header.find(stem); listed != folder_of_header.end())
    return listed->second;
  // A subcommand may bear the same name: the lowest serves the header.
  std::string lowest;
  for (const auto& [other, names] : tree) {
    if (!other.starts_with("src/") || !other.ends_with("/" + stem + ".cpp")) continue;
    const std::string folder = folder_of(other, tree);
    if (lowest.empty() ||
        std::find(ranks.begin(), ranks.end(), folder) < std::find(ranks.begin(), ranks.end(), lowest))
      lowest = folder;
  }
  return lowest;
}

std::optional<std::size_t> rank_of(const std::string& path, const Includes& tree) {
  const auto at = std::find(ranks.begin(), ranks.end(), folder_of(path, tree));
  if (at == ranks.end()) return std::nullopt;
  return at - ranks.begin();
}

// The file of the project that an include names; empty for others.
std::string included_file(const std::string& from, const std::string& name, const Includes& tree) {
  const std::string beside = from.substr(0, from.rfind('/') + 1) + name;
  for (const std::string& path : {beside, "src/" + name, "include/" + name, "surfaces/" + name})
    if (tree.contains(path)) return path;
  return "";
}

std::vector<std::string> upward_includes(const Includes& tree) {
  std::vector<std::string> result;
  for (const auto& [path, includes] : tree) {
    const auto rank = rank_of(path, tree);
    if (!rank) {
      result.push_back(path + " is in no folder that has a rank: give it one in tests/tree/arrows_test.cpp");
      continue;
    }
    for (const std::string& name : includes) {
      const std::string file = included_file(path, name, tree);
      if (file.empty()) {
        // Private headers are found by their folder; all else in quotes would escape.
        if (name.starts_with("darboux/") || name.starts_with("../"))
          result.push_back(path + " includes " + name + ", which is nowhere in the tree");
        continue;
      }
      if (const auto other = rank_of(file, tree); other && *other > *rank)
        result.push_back(path + " includes " + name + " of " + folder_of(file, tree) +
                         ", which stands above " + folder_of(path, tree));
    }
  }
  return result;
}

// ---- rules beside the ranks -------------------------------------------------------------------------------

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
  return {
      {"a surface knows no engine", "surfaces/darboux/(?!catalogue\\.h).*",
       std::string(standard) + "|darboux/(surface|scalar|vector|curve|framed_curve|spline_patch)\\.h", ""},
      {"the catalogue only lists", "surfaces/darboux/catalogue\\.h", surfaces, ""},
      {"the engine knows no particular surface", "include/.*", "", surfaces},
      {"binary, error and attributes stand below everything", "include/darboux/(binary|error|attributes)\\.h",
       standard, ""},
      {"scalar stands on elementary, that on binary", "include/darboux/(scalar|elementary)\\.h",
       std::string(standard) + "|darboux/(binary|elementary)\\.h", ""},
      {"vector and multiprecision stand on scalar", "include/darboux/(vector|multiprecision)\\.h",
       std::string(standard) + "|Eigen/.*|darboux/scalar\\.h", ""},
      {"curves know no engine", "include/darboux/(curve|spline)\\.h",
       std::string(standard) + "|darboux/(binary|scalar|vector|surface|spline|error)\\.h", ""},
      {"surface.h stands on scalar and vector", "include/darboux/surface\\.h",
       std::string(standard) + "|darboux/(scalar|vector)\\.h", ""},
      {"a mesh knows no parametric surface, only its plain types", "src/mesh/(?!sample/).*", "",
       "darboux/"
       "(limit|point|forms|shape_operator|curvature|christoffel|darboux_frame|differentiate|curve|spline|"
       "placed|offset|reparametrised|from_position)\\.h"},
      {"public headers show Eigen and the standard library only", "(include|surfaces)/.*",
       std::string(standard) + "|Eigen/.*|darboux/.*", ""},
      {"only these know all surfaces", "(?!src/(any_surface|fit|evaluate/kernels|work_precision|cli)/).*", "",
       "darboux/catalogue\\.h"},
      {"the fits stand side by side on what they share", "src/fit/(uv|primitives|catalogue)/.*", "",
       "fit/(uv|primitives|catalogue)/.*"},
      {"the command line knows public headers, reports, base, and the faces that rooms show it", "src/cli/.*",
       "",
       "(?!report/|base/|study/|io/(files|input|json_cursor|scene_file|scene_tiles|unfinished)\\.h|assets/"
       "(map_source|scene_of_gltf|triangles_beside)\\.h|validate/"
       "findings\\.h)"
       "(surface|mesh|evaluate|any_surface|laws|local_jets|validate|fit|assess|converge|scene|normal_map|io|"
       "assets)/.*"},
      // Other libraries, each behind one room.
      {"boost stays behind multiprecision and the quantiles of distributions",
       "(?!src/surface/multiprecision\\.cpp|src/fit/common/intervals\\.cpp|src/base/student_t\\.cpp).*", "",
       "boost/.*"},
      {"xsimd stays in the kernels", "(?!src/evaluate/kernels/).*", "", "xsimd/.*"},
      {"oneTBB stays behind the parallel loops", "(?!src/base/parallel\\.h).*", "", "tbb/.*"},
      {"nanoflann stays behind the k-d tree", "(?!src/base/neighbours\\.h).*", "", "nanoflann\\.hpp"},
      {"Ceres stays behind the fit", "(?!src/fit/).*", "", "ceres/.*|glog/.*"},
      {"JSON stays behind files, reports and the command line", "(?!src/(io|assets|study|cli|report)/).*", "",
       "nlohmann/.*"},
      {"the file libraries stay behind io", "(?!src/io/).*", "",
       "assimp/.*|tiny_gltf\\.h|draco/.*|png\\.h|Imf.*|stb_.*|meshoptimizer\\.h|muParser.*"},
      {"CLI11 stays in the command line", "(?!src/cli/).*", "", "CLI/.*"},
      {"the library needs no test framework", ".*", "", "gtest/.*|gmock/.*"},
  };
}

std::vector<std::string> violations(const Includes& tree) {
  std::vector<std::string> result = upward_includes(tree);
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

TEST(Arrows, EveryRankIsAFolderWithSources) {
  const Includes tree = includes_below({"include", "surfaces", "src"});
  for (const std::string& folder : ranks)
    EXPECT_TRUE(std::any_of(tree.begin(), tree.end(),
                            [&](const auto& file) { return folder_of(file.first, tree) == folder; }))
        << folder << " holds nothing";
  for (const auto& [header, folder] : folder_of_header)
    EXPECT_TRUE(tree.contains("include/darboux/" + header + ".h"))
        << header << ".h is listed and is not there";
}

// A tree in order, to put one bad include into.
Includes good_tree() {
  return {
      {"surfaces/darboux/torus.h", {"array", "darboux/surface.h"}},
      {"surfaces/darboux/catalogue.h", {"darboux/torus.h"}},
      {"include/darboux/vector.h", {"darboux/scalar.h"}},
      {"include/darboux/scalar.h", {"cmath"}},
      {"include/darboux/surface.h", {"darboux/vector.h"}},
      {"src/surface/refusals.cpp", {"darboux/surface.h"}},
      {"include/darboux/frame.h", {"cmath", "Eigen/Geometry", "darboux/surface.h"}},
      {"include/darboux/mesh.h", {"vector", "darboux/vector.h"}},
      {"src/mesh/mesh.cpp", {"darboux/mesh.h"}},
      {"include/darboux/any_surface.h", {"darboux/evaluate.h"}},
      {"src/any_surface/any_surface.cpp", {"darboux/any_surface.h", "darboux/catalogue.h"}},
      {"include/darboux/evaluate.h", {"darboux/frame.h"}},
      {"src/evaluate/evaluate.cpp", {"darboux/evaluate.h", "evaluate/kernels/lanes.h", "base/parallel.h"}},
      {"src/base/parallel.h", {"tbb/parallel_for.h"}},
      {"src/evaluate/kernels/lanes.h", {"xsimd/xsimd.hpp"}},
      {"include/darboux/validate.h", {"darboux/mesh.h"}},
      {"src/validate/validate.cpp", {"darboux/validate.h", "findings.h"}},
      {"src/validate/findings.h", {}},
      {"include/darboux/fit_mesh.h", {"darboux/any_surface.h"}},
      {"src/fit/fit_mesh.cpp", {"ceres/ceres.h", "darboux/catalogue.h", "fit/uv/uv_kinds.h"}},
      {"src/fit/uv/uv_kinds.h", {}},
      {"src/fit/primitives/prepare.cpp", {"prepare.h"}},
      {"src/fit/primitives/prepare.h", {}},
      {"src/fit/common/normalised_points.h", {"base/text.h"}},
      {"src/base/text.h", {}},
      {"include/darboux/io.h", {"darboux/mesh.h"}},
      {"src/io/gltf.cpp", {"nlohmann/json.hpp", "assimp/scene.h", "accessor.h"}},
      {"src/io/accessor.h", {}},
      {"src/report/page.h", {"darboux/mesh.h"}},
      {"src/cli/main.cpp",
       {"CLI/CLI.hpp", "report/page.h", "darboux/catalogue.h", "nlohmann/json.hpp", "base/text.h"}}};
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
      {"include/darboux/frame.h", "darboux/nowhere.h"},
      {"include/darboux/surface.h", "darboux/frame.h"},
      {"include/darboux/scalar.h", "darboux/surface.h"},
      {"include/darboux/scalar.h", "darboux/vector.h"},
      {"include/darboux/vector.h", "darboux/surface.h"},
      {"include/darboux/mesh.h", "darboux/any_surface.h"},
      {"include/darboux/mesh.h", "darboux/evaluate.h"},
      {"include/darboux/evaluate.h", "xsimd/xsimd.hpp"},
      {"include/darboux/frame.h", "boost/multiprecision/cpp_bin_float.hpp"},
      {"include/darboux/fit_mesh.h", "ceres/ceres.h"},
      {"include/darboux/io.h", "nlohmann/json.hpp"},
      {"include/darboux/io.h", "assimp/scene.h"},
      {"include/darboux/frame.h", "gtest/gtest.h"},
      {"src/base/text.h", "darboux/surface.h"},
      {"src/mesh/mesh.cpp", "darboux/evaluate.h"},
      {"src/mesh/mesh.cpp", "darboux/any_surface.h"},
      {"src/mesh/mesh.cpp", "darboux/io.h"},
      {"src/evaluate/kernels/lanes.h", "darboux/evaluate.h"},
      {"src/validate/validate.cpp", "darboux/fit_mesh.h"},
      {"src/validate/validate.cpp", "ceres/ceres.h"},
      {"src/validate/validate.cpp", "tbb/parallel_for.h"},
      {"src/validate/validate.cpp", "darboux/catalogue.h"},
      {"src/validate/validate.cpp", "nlohmann/json.hpp"},
      {"src/validate/validate.cpp", "report/page.h"},
      {"src/fit/primitives/prepare.cpp", "nanoflann.hpp"},
      {"src/fit/primitives/prepare.cpp", "fit/uv/uv_kinds.h"},
      {"src/fit/common/normalised_points.h", "fit/uv/uv_kinds.h"},
      {"src/fit/uv/uv_kinds.h", "../primitives/starts.h"},
      {"src/io/gltf.cpp", "report/page.h"},
      {"src/cli/main.cpp", "assimp/scene.h"},
      {"src/cli/main.cpp", "io/accessor.h"},
      {"src/cli/main.cpp", "fit/uv/uv_kinds.h"},
      {"src/report/page.h", "CLI/CLI.hpp"},
      {"src/report/page.h", "darboux/catalogue.h"},
  };
  for (const auto& [path, name] : wrong) {
    Includes tree = good_tree();
    tree.at(path).push_back(name);
    EXPECT_FALSE(violations(tree).empty()) << path << " may include " << name;
  }
}

TEST(Arrows, AFileInNoRoomIsFound) {
  for (const char* path : {"src/loose.cpp", "src/loose.h", "src/attic/old.cpp", "src/fit/attic/old.h",
                           "include/darboux/unserved.h"}) {
    Includes tree = good_tree();
    tree[path] = {};
    EXPECT_FALSE(violations(tree).empty()) << path;
  }
}

TEST(IncludedBy, ReadsDirectivesOnly) {
  EXPECT_EQ(
      included_by(
          "#include <cmath>\n  #  include \"a/b.h\"\n// #include <no>\nconst char* s = \"#include <no>\";\n"),
      (std::vector<std::string>{"cmath", "a/b.h"}));
}

}  // namespace
}  // namespace darboux::test::arrows_test
