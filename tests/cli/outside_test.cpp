// Files that a document names outside of its folder are opened only where that is allowed.
#include "cli.h"

namespace darboux::test::outside_test {
namespace {

class Outside : public Cli {
 protected:
  Outside() {
    fs::create_directories(path("asset/sub"));
    const std::string glb = read_bytes(path("data/torus_016.three.glb"));
    Glb parts = split_glb(glb);
    json_ = parts.json;
    bin_ = parts.bin;
    for (const char* name : {"secret.bin", "asset/in.bin", "asset/sub/in.bin"}) write_bytes(path(name), bin_);
    fs::create_symlink("../secret.bin", path("asset/link.bin"));
    fs::create_symlink("in.bin", path("asset/link-inside.bin"));
    fs::create_directory_symlink("..", path("asset/up"));
    write_bytes(path("secret.png"), "\x89PNG\r\n\x1a\n and more");
  }

  void write_document(const std::string& buffer, const std::string& image = "") {
    Json json = json_;
    json["buffers"][0]["uri"] = buffer;
    if (!image.empty()) json["images"] = Json::array({{{"uri", image}}});
    write_bytes(path("asset/m.gltf"), json.dump());
  }

  Json json_;
  std::string bin_;
};

TEST_F(Outside, BuffersAreRefusedUnlessAllowed) {
  good("cp data/torus_016.three.glb other.glb; cd asset && ln -s . here");
  for (const std::string uri : {"../secret.bin", "%2e%2e/secret.bin", "sub/../../secret.bin", "link.bin",
                                "up/secret.bin", "here/../secret.bin"}) {
    write_document(uri);
    for (const std::string command :
         {"validate asset/m.gltf", "tangents asset/m.gltf -o out.glb", "compare asset/m.gltf other.glb",
          "compare other.glb asset/m.gltf", "plan --splits asset/m.gltf", "scene asset/m.gltf"}) {
      SCOPED_TRACE(command + " with " + uri);
      const Result r = sh("darboux " + command);
      EXPECT_EQ(r.status, 2);
      expect_one_line(r.err);
      EXPECT_NE(r.err.find("asset/m.gltf: buffers[0].uri: "), std::string::npos) << r.err;
      EXPECT_NE(r.err.find("--allow-outside"), std::string::npos) << r.err;
      EXPECT_FALSE(fs::exists(path("out.glb")));
      const Result allowed = sh("darboux " + command + " --allow-outside");
      EXPECT_NE(allowed.status, 2) << allowed.err;
      fs::remove(path("out.glb"));
    }
  }
}

TEST_F(Outside, WhatLiesInTheFolderIsRead) {
  for (const std::string uri : {"in.bin", "./in.bin", "sub/in.bin", "sub/../in.bin", "../asset/in.bin",
                                "link-inside.bin", "up/asset/in.bin"}) {
    write_document(uri);
    good("darboux validate asset/m.gltf");
    good("cd asset && darboux validate m.gltf && cd sub && darboux validate ../m.gltf");
  }
}

// A link to an asset: what lies beside the link is read, and what lies beside the asset.
TEST_F(Outside, ALinkBelongsToBothFolders) {
  write_document("in.bin");
  good(
      "mkdir links mixed && ln -s ../asset/m.gltf links && ln -s ../asset/in.bin links && ln -s "
      "../asset/m.gltf mixed");
  good("darboux validate links/m.gltf");
  good("cp asset/in.bin mixed && darboux validate mixed/m.gltf");
  good("rm mixed/in.bin && ln -s ../secret.bin mixed/in.bin");
  EXPECT_EQ(sh("darboux validate mixed/m.gltf").status, 2);
}

// Only `tangents` opens images, to embed them; elsewhere their names are no more than texts.
TEST_F(Outside, ImagesAreRefusedWhereTheyAreOpened) {
  write_document("in.bin", "../secret.png");
  good("darboux validate asset/m.gltf");
  good("darboux plan asset/m.gltf");
  refused("darboux tangents asset/m.gltf -o out.glb", {"an image", "../secret.png", "--allow-outside"});
  EXPECT_FALSE(fs::exists(path("out.glb")));
  good("darboux tangents asset/m.gltf -o out.glb --allow-outside --quiet");
  EXPECT_NE(read_bytes(path("out.glb")).find("data:image/png;base64,"), std::string::npos);
  // One that is not there keeps its name.
  write_document("in.bin", "../missing.png");
  const auto missing = sh("darboux tangents asset/m.gltf -o out.glb");
  EXPECT_EQ(missing.status, 0);
  EXPECT_NE(missing.err.find("images[0] keeps its URI"), std::string::npos) << missing.err;
  EXPECT_NE(read_bytes(path("out.glb")).find("../missing.png"), std::string::npos);
}

// What assimp reads, it reads in a process that can open nothing; without that fence it reads the same.
TEST_F(Outside, TheFenceChangesNoVerdict) {
  const std::string command = "darboux validate data/sphere_016.obj --json";
  EXPECT_EQ(json(command)["files"], json(command + " --no-sandbox")["files"]);
}

}  // namespace
}  // namespace darboux::test::outside_test
