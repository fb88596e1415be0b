// One surface, one header, one line in catalogue.h: nothing in surfaces/ may be missing from the list.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/multiprecision.h>

#include "source_tree.h"

namespace darboux::test::catalogue_test {
namespace {

// "moebius_strip" -> "MoebiusStrip"
std::string type_name(const std::string& header) {
  std::string name;
  bool capital = true;
  for (const char c : header) {
    if (c != '_') name += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    capital = c == '_';
  }
  return std::regex_replace(name, std::regex("^Bspline"), "BSpline");
}

// What a catalogue's text says wrongly about these headers.
std::vector<std::string> faults(const std::string& catalogue, const std::set<std::string>& headers) {
  std::vector<std::string> result;
  const std::vector<std::string> included = included_by(catalogue);
  std::smatch list;
  std::regex_search(catalogue, list, std::regex("SurfaceList<((?:.|\n)*?)>;"));
  const std::string listed = list[1];
  for (const std::string& header : headers) {
    if (std::count(included.begin(), included.end(), "darboux/" + header + ".h") != 1)
      result.push_back(header + ".h is not included");
    if (!std::regex_search(listed, std::regex("\\b" + type_name(header) + "<>")))
      result.push_back(type_name(header) + " is not listed");
  }
  return result;
}

std::set<std::string> surface_headers() {
  std::set<std::string> result;
  for (const auto& entry : std::filesystem::directory_iterator(DARBOUX_SOURCE "/surfaces/darboux"))
    if (entry.path().extension() == ".h" && entry.path().stem() != "catalogue")
      result.insert(entry.path().stem().string());
  return result;
}

TEST(Catalogue, ListsEveryHeader) {
  EXPECT_EQ(surface_headers().size(), 27U);
  for (const std::string& fault :
       faults(read_text(DARBOUX_SOURCE "/surfaces/darboux/catalogue.h"), surface_headers()))
    ADD_FAILURE() << "surfaces/darboux/catalogue.h: " << fault;
}

// The header is named like its surface on the command line, so that one is found from the other.
TEST(Catalogue, NamesSurfacesLikeTheirHeaders) {
  std::set<std::string> names;
  Catalogue::for_each([&](const auto& surface) {
    std::string name(surface.info.name);
    std::replace(name.begin(), name.end(), '-', '_');
    names.insert(name);
  });
  EXPECT_EQ(names, surface_headers());
}

TEST(Catalogue, AMissingHeaderIsFound) {
  const std::string text = "#include <darboux/sphere.h>\nusing Catalogue = SurfaceList<Sphere<>>;";
  EXPECT_TRUE(faults(text, {"sphere"}).empty());
  EXPECT_EQ(faults(text, {"sphere", "moebius_strip"}),
            (std::vector<std::string>{"moebius_strip.h is not included", "MoebiusStrip is not listed"}));
  EXPECT_EQ(faults("#include <darboux/sphere.h>\nusing Catalogue = SurfaceList<Spheroid<>>;", {"sphere"}),
            std::vector<std::string>{"Sphere is not listed"});
}

TEST(Rebind, CarriesTheParametersToAnotherScalar) {
  const Torus<float> single = rebind<float>(Torus{3.0, 0.1});
  EXPECT_EQ(single.major_radius, 3.0F);
  EXPECT_EQ(single.minor_radius, 0.1F);
  EXPECT_EQ(rebind<Multiprecision>(Cylinder{0.1, 2.0}).radius, Multiprecision(0.1));
  EXPECT_EQ(rebind<double>(single).minor_radius, static_cast<double>(0.1F));
}

}  // namespace
}  // namespace darboux::test::catalogue_test
