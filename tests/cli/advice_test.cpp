// The advice of validate, followed: what `darboux tangents` mends is mended.
#include <filesystem>

#include "cli.h"

namespace darboux::test {
namespace {

std::vector<std::string> tangent_errors(const nlohmann::json& document) {
  std::vector<std::string> codes;
  for (const auto& mesh : document["files"][0]["meshes"])
    for (const auto& finding : mesh["findings"])
      if (finding["severity"] == "error" && finding["code"].get<std::string>().starts_with("TANGENT_"))
        codes.push_back(finding["code"]);
  return codes;
}

TEST_F(Cli, TangentsMendWhatValidateFindsInThem) {
  const fs::path shared = fs::path(DARBOUX_SHARED) / "meshes";
  if (!fs::exists(shared)) GTEST_SKIP() << "SKIPPED: " << shared << " is absent, no file of others is mended";
  std::size_t mended = 0;
  for (const auto& entry : fs::recursive_directory_iterator(shared)) {
    if (entry.path().extension() != ".glb" && entry.path().extension() != ".gltf") continue;
    SCOPED_TRACE(entry.path().string());
    const std::string file = "'" + entry.path().string() + "'";
    const auto before = nlohmann::json::parse(sh("darboux validate " + file + " --json").out);
    if (tangent_errors(before).empty()) continue;
    // Without uvs there are no tangents to write, and the command says so.
    if (sh("darboux tangents " + file + " -o mended.glb").status != 0) continue;
    const auto after = nlohmann::json::parse(sh("darboux validate mended.glb --json").out);
    EXPECT_EQ(tangent_errors(after), std::vector<std::string>{});
    ++mended;
  }
  EXPECT_GE(mended, 4u);
}

}  // namespace
}  // namespace darboux::test
