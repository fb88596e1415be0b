// The advice of validate, followed: what `darboux tangents` mends passes.
#include <filesystem>
#include <iostream>
#include <set>

#include "cli.h"

namespace darboux::test::advice_test {
namespace {

// The errors of a report that new tangents mend, and the others.
struct Errors {
  std::set<std::string> mended, others;

  explicit Errors(const nlohmann::json& document) {
    for (const auto& file : document["files"])
      for (const auto& mesh : file["meshes"])
        for (const auto& finding : mesh["findings"])
          if (const std::string code = finding["code"]; finding["severity"] == "error")
            (code.starts_with("TANGENT_") ? mended : others).insert(code);
  }
};

// Why a file cannot be mended to the end, or nothing.
std::string left_out_for(const fs::path& file, const Errors& errors) {
  const std::string extension = file.extension().string();
  if (extension != ".glb" && extension != ".gltf") return "darboux tangents reads and writes glTF only";
  if (errors.others.empty()) return "";
  std::string codes;
  for (const std::string& code : errors.others) codes += (codes.empty() ? "" : ", ") + code;
  return "new tangents do not mend its " + codes;
}

TEST_F(Cli, TangentsMendWhatValidateFindsInThem) {
  const fs::path shared = fs::path(DARBOUX_SHARED) / "meshes";
  if (!fs::exists(shared)) GTEST_SKIP() << "SKIPPED: " << shared << " is absent, no file of others is mended";
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(shared))
    if (entry.is_regular_file()) files.insert(entry.path());
  std::size_t mended = 0;
  for (const fs::path& path : files) {
    SCOPED_TRACE(path.string());
    const std::string file = "'" + path.string() + "'";
    const Result read = sh("darboux validate " + file + " --json");
    if (read.status > 1) continue;  // no mesh file
    const Errors before(nlohmann::json::parse(read.out));
    if (before.mended.empty()) continue;
    const std::string name = fs::relative(path, shared).string();
    const std::string why = left_out_for(path, before);
    if (!why.empty()) std::cout << "LEFT OUT: " << name << ": " << why << '\n';
    if (!path.extension().string().starts_with(".gl")) continue;
    const Result made = sh("darboux tangents " + file + " -o mended.glb");
    if (made.status != 0) {
      std::cout << "LEFT OUT: " << name << ": darboux tangents says " << lines(made.out + made.err).at(0)
                << '\n';
      continue;
    }
    const Result after = sh("darboux validate mended.glb --json");
    const auto document = nlohmann::json::parse(after.out);
    EXPECT_EQ(Errors(document).mended, std::set<std::string>{});
    if (!why.empty()) continue;
    EXPECT_EQ(document["verdict"], "pass");
    EXPECT_EQ(after.status, 0);
    ++mended;
  }
  // Two spheres whose poles have no tangent, and a model whose tangents lean on their normals.
  EXPECT_GE(mended, 3u);
}

// Tangents of uvs that KHR_texture_transform turns are those that validate expects, and it names them.
TEST_F(Cli, TangentsOfTransformedUvsPass) {
  for (const auto& transform : {nlohmann::ordered_json{{"rotation", 0.7}},
                                nlohmann::ordered_json{{"scale", {-1, 1}}, {"offset", {0.5, 0.25}}},
                                nlohmann::ordered_json{{"rotation", -2}, {"scale", {3, 2}}}}) {
    SCOPED_TRACE(transform.dump());
    Glb glb = split_glb(read_bytes(path("data/jittertorus_016.mikk.glb")));
    glb.json["materials"] = {
        {{"normalTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}};
    glb.json["meshes"][0]["primitives"][0]["material"] = 0;
    write_bytes(path("turned.glb"), make_glb(glb.json.dump(), glb.bin));
    good("darboux tangents turned.glb -o made.glb");
    EXPECT_EQ(sh("darboux compare turned.glb made.glb").status, 1);
    const auto document = json("darboux validate made.glb --json");
    EXPECT_EQ(document["verdict"], "pass");
    EXPECT_TRUE(has_finding(only_mesh(document), "TANGENT_TEXTURE_TRANSFORM"))
        << only_mesh(document)["findings"];
  }
}

}  // namespace
}  // namespace darboux::test::advice_test
