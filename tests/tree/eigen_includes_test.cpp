// Members that Eigen/Core declares and another header of Eigen's defines: without it a source compiles, with
// a precompiled header it links too, and without one it does not (preset clang).
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace darboux::test::eigen_includes_test {
namespace {

struct Definitions {
  std::regex calls;                    // in the text of a source
  std::set<std::string> with_headers;  // any of these defines what is called
};

// By the includes of Eigen 3.4's own headers.
const std::vector<Definitions> definitions{
    {std::regex("\\.(cross|unitOrthogonal)\\("), {"Eigen/Geometry", "Eigen/Eigenvalues", "Eigen/Dense"}},
    {std::regex("\\.(inverse|determinant|(partialPiv|fullPiv)Lu)\\("),
     {"Eigen/LU", "Eigen/Geometry", "Eigen/Eigenvalues", "Eigen/Dense"}},
    {std::regex("\\.(llt|ldlt)\\("),
     {"Eigen/Cholesky", "Eigen/QR", "Eigen/SVD", "Eigen/Geometry", "Eigen/Eigenvalues", "Eigen/Dense"}},
    {std::regex("\\.(([cC]olPiv|fullPiv)?[hH]ouseholderQr|completeOrthogonalDecomposition)\\("),
     {"Eigen/QR", "Eigen/SVD", "Eigen/Geometry", "Eigen/Dense"}},
    {std::regex("\\.(jacobiSvd|bdcSvd)\\("), {"Eigen/SVD", "Eigen/Geometry", "Eigen/Dense"}},
    {std::regex("\\.(eigenvalues|operatorNorm)\\(\\)"), {"Eigen/Eigenvalues", "Eigen/Dense"}},
};

// All that a file includes, and its files of the project include.
void reach(const std::string& path, const Includes& tree, std::set<std::string>& reached) {
  for (const std::string& name : tree.at(path)) {
    if (!reached.insert(name).second) continue;
    const std::string beside = path.substr(0, path.rfind('/') + 1) + name;
    for (const std::string& file : {beside, "src/" + name, "include/" + name, "surfaces/" + name})
      if (tree.contains(file)) {
        reach(file, tree, reached);
        break;
      }
  }
}

// Of a file with this text: the first call whose definition it does not reach; empty where there is none.
std::string undefined_call(const std::string& path, const std::string& text, const Includes& tree) {
  std::set<std::string> reached;
  reach(path, tree, reached);
  for (const Definitions& of : definitions) {
    std::smatch call;
    if (!std::regex_search(text, call, of.calls)) continue;
    bool defined = false;
    for (const std::string& header : of.with_headers) defined = defined || reached.contains(header);
    if (!defined) return call.str();
  }
  return "";
}

TEST(EigenIncludes, EverySourceReachesTheDefinitionsOfWhatItCalls) {
  const Includes tree = includes_below({"include", "surfaces", "src"});
  int calls = 0;
  for (const auto& [path, includes] : tree) {
    const std::string text = read_text(std::filesystem::path(DARBOUX_SOURCE) / path);
    calls += std::regex_search(text, definitions.front().calls);
    EXPECT_EQ(undefined_call(path, text, tree), "") << path;
  }
  EXPECT_GT(calls, 10) << "the calls are no longer found";
}

TEST(EigenIncludes, AMissingHeaderIsFound) {
  Includes tree{{"src/fit/a.cpp", {"a.h", "cmath"}},
                {"src/fit/a.h", {"darboux/vector.h"}},
                {"include/darboux/vector.h", {"Eigen/Core"}}};
  const std::map<std::string, std::string> header_of_call{
      {"x.cross(y)", "Eigen/Geometry"},        {"m.inverse()", "Eigen/LU"},
      {"m.ldlt().solve(b)", "Eigen/Cholesky"}, {"m.colPivHouseholderQr()", "Eigen/QR"},
      {"m.jacobiSvd()", "Eigen/SVD"},          {"m.eigenvalues()", "Eigen/Eigenvalues"}};
  for (const auto& [call, header] : header_of_call) {
    EXPECT_NE(undefined_call("src/fit/a.cpp", call, tree), "") << call;
    Includes with = tree;
    with.at("include/darboux/vector.h").push_back(header);
    EXPECT_EQ(undefined_call("src/fit/a.cpp", call, with), "") << call;
  }
  EXPECT_EQ(undefined_call("src/fit/a.cpp", "cross(x, y) + x.dot(y)", tree), "");
}

}  // namespace
}  // namespace darboux::test::eigen_includes_test
