// `validate --paint`: the colours, read by TinyGLTF, are those of the errors that the library keeps, and all
// else stays. `validate --report`: what can be seen of the page without a browser; tests/browser looks at it
// in one.
#include <set>

#include "cli.h"

#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

#include <darboux/assess.h>
#include <darboux/io.h>

#include "generated_gltf.h"

namespace darboux::test::pictures_test {
namespace {

bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*,
                  int, void*) {
  return true;
}

tinygltf::Model load(const std::string& path) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(ignore_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path)) << error;
  return model;
}

std::vector<Vec3<float>> colours_of(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(primitive.attributes.at("COLOR_0")));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
  EXPECT_EQ(accessor.type, TINYGLTF_TYPE_VEC3);
  std::vector<Vec3<float>> result(accessor.count);
  std::memcpy(result.data(), &model.buffers.at(0).data.at(view.byteOffset + accessor.byteOffset),
              12 * accessor.count);
  return result;
}

// The error at each vertex, from the library.
std::vector<std::vector<float>> errors_of(const std::string& path) {
  AssessOptions options;
  options.keep_errors = true;
  std::vector<std::vector<float>> result;
  for (const Primitive& p : read_asset(path).primitives) {
    std::vector<float>& errors = result.emplace_back(p.data.positions.size(), -1.0f);
    for (const Assessment& j : assess_parts(p.data, options))
      for (std::size_t c = 0; c < j.report.errors_deg.size(); ++c) {
        float& at = errors[p.data.triangles[j.triangles.empty() ? c / 3 : j.triangles[c / 3]][c % 3]];
        if (j.report.errors_deg[c] > at) at = j.report.errors_deg[c];
      }
  }
  return result;
}

// What the extras say an error is shown as.
Vec3<float> shown(const Json& legend, float error) {
  const auto rgb = [](const Json& c) { return Vec3<float>{c[0], c[1], c[2]}; };
  if (error < 0) return rgb(legend["not compared"]);
  const Json& colours = legend["colours"];
  const double from = legend["from"], to = legend["to"];
  const double at = std::fmin((error - from) / (to - from), 1) * static_cast<double>(colours.size() - 1);
  const auto below = static_cast<std::size_t>(std::fmin(at, static_cast<double>(colours.size() - 2)));
  const auto t = static_cast<float>(at - static_cast<double>(below));
  return (1 - t) * rgb(colours[below]) + t * rgb(colours[below + 1]);
}

// Assessed and painted, vertex by vertex; returns how many different colours there are.
std::size_t expect_painted(const std::string& input, const std::string& painted) {
  const auto errors = errors_of(input);
  const tinygltf::Model model = load(painted);
  const Json json = split_glb(read_bytes(painted)).json;
  std::set<std::array<float, 3>> different;
  std::size_t k = 0;
  for (std::size_t m = 0; m < model.meshes.size(); ++m)
    for (const tinygltf::Primitive& p : model.meshes[m].primitives) {
      if (p.mode < TINYGLTF_MODE_TRIANGLES) continue;
      const Json& legend = json["meshes"][m]["extras"]["darboux"];
      EXPECT_EQ(legend["unit"], "deg");
      const std::vector<Vec3<float>> colours = colours_of(model, p);
      EXPECT_EQ(colours.size(), errors.at(k).size());
      for (std::size_t v = 0; v < colours.size(); ++v) {
        const Vec3<float> wanted = shown(legend, errors[k][v]);
        // The interpolation is rounded to float, here and there.
        EXPECT_NEAR(colours[v].x, wanted.x, 1e-6) << v;
        EXPECT_NEAR(colours[v].y, wanted.y, 1e-6) << v;
        EXPECT_NEAR(colours[v].z, wanted.z, 1e-6) << v;
        different.insert({colours[v].x, colours[v].y, colours[v].z});
      }
      const auto& material = model.materials.at(static_cast<std::size_t>(p.material));
      EXPECT_EQ(material.extensions.count("KHR_materials_unlit"), 1u);
      EXPECT_EQ(material.pbrMetallicRoughness.baseColorTexture.index, -1);
      ++k;
    }
  EXPECT_EQ(k, errors.size());
  return different.size();
}

// The document before, from the one after.
void expect_only_painted(const Glb& before, const Glb& after) {
  EXPECT_TRUE(after.bin.starts_with(before.bin));
  Json json = after.json;
  for (std::size_t m = 0; m < json["meshes"].size(); ++m) {
    const Json& old_mesh = before.json["meshes"][m];
    Json& mesh = json["meshes"][m];
    for (std::size_t p = 0; p < mesh["primitives"].size(); ++p) {
      const Json& old = old_mesh["primitives"][p];
      Json& primitive = mesh["primitives"][p];
      if (old["attributes"].contains("COLOR_0"))
        primitive["attributes"]["COLOR_0"] = old["attributes"]["COLOR_0"];
      else
        primitive["attributes"].erase("COLOR_0");
      if (old.contains("material"))
        primitive["material"] = old["material"];
      else
        primitive.erase("material");
    }
    mesh["extras"].erase("darboux");
    if (!old_mesh.contains("extras")) mesh.erase("extras");
  }
  for (const char* key : {"accessors", "bufferViews", "materials", "extensionsUsed"}) {
    const std::size_t old = before.json.contains(key) ? before.json[key].size() : 0;
    while (json[key].size() > old) json[key].erase(json[key].size() - 1);
    if (old == 0) json.erase(key);
  }
  json["buffers"][0]["byteLength"] = before.json["buffers"][0]["byteLength"];
  EXPECT_EQ(json.dump(), before.json.dump());
}

TEST_F(Cli, PaintShowsTheErrorsAndKeepsAllElse) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(DARBOUX_TEST_DATA)) {
    if (entry.path().extension() != ".glb") continue;
    const std::string name = entry.path().filename().string();
    SCOPED_TRACE(name);
    ++files;
    const Json plain = Json::parse(sh("darboux validate --json data/" + name).out);
    const Json painting = Json::parse(sh("darboux validate --json data/" + name + " --paint out.glb").out);
    EXPECT_EQ(painting, plain) << "the report does not depend on it";
    expect_painted(path("data/" + name), path("out.glb"));
    expect_only_painted(split_glb(read_bytes(path("data/" + name))), split_glb(read_bytes(path("out.glb"))));
    EXPECT_EQ(Json::parse(sh("darboux validate --json out.glb").out)["files"][0]["meshes"],
              plain["files"][0]["meshes"])
        << "the painted mesh is the same mesh";
  }
  EXPECT_GE(files, 10u);
}

// Strips, points, morph targets, shared accessors, colours and materials of its own.
TEST_F(Cli, PaintOfAFileWithEverything) {
  write_bytes(path("in.glb"), generated_gltf().glb());
  sh("darboux validate in.glb --paint out.glb");
  expect_painted(path("in.glb"), path("out.glb"));
  expect_only_painted(split_glb(read_bytes(path("in.glb"))), split_glb(read_bytes(path("out.glb"))));
  // Painted again it gets no second material.
  sh("darboux validate out.glb --paint again.glb");
  EXPECT_EQ(split_glb(read_bytes(path("again.glb"))).json["materials"],
            split_glb(read_bytes(path("out.glb"))).json["materials"]);
}

TEST_F(Cli, PaintOfOtherFormatsIsANewFile) {
  for (const char* name : {"data/torus_016.obj", "data/sphere_016.obj"}) {
    sh(std::string("darboux validate ") + name + " --paint out.glb");
    expect_painted(path(name), path("out.glb"));
    const Json json = split_glb(read_bytes(path("out.glb"))).json;
    EXPECT_EQ(json["meshes"][0]["extras"]["darboux"]["paint"], "normal error");
    EXPECT_EQ(read_asset(path("out.glb")).primitives.size(), read_asset(path(name)).primitives.size());
  }
}

// The scale ends at --max-angle; what is not compared is grey; NaN and extras that are no object go through.
TEST_F(Cli, PaintScaleAndWhatIsNotCompared) {
  good("darboux validate data/torus_016.three.glb --paint wide.glb --max-angle 90");
  good("darboux validate data/torus_016.three.glb --paint narrow.glb --max-angle 2");
  const auto colours = [&](const char* name) {
    const tinygltf::Model model = load(path(name));
    return colours_of(model, model.meshes[0].primitives[0]);
  };
  const Json legend = split_glb(read_bytes(path("narrow.glb"))).json["meshes"][0]["extras"]["darboux"];
  EXPECT_EQ(legend["paint"], "tangent error");
  EXPECT_EQ(legend["from"], 0);
  EXPECT_EQ(legend["to"], 2.0);
  const Vec3<float> last = shown(legend, 1000), grey = shown(legend, -1);
  std::size_t saturated = 0;
  for (const auto& c : colours("narrow.glb")) saturated += c == last;
  EXPECT_GT(saturated, 10u) << "the seam is off by up to 3.8 degrees";
  for (const auto& c : colours("wide.glb")) EXPECT_FALSE(c == last);

  Glb glb = split_glb(read_bytes(path("data/torus_016.three.glb")));
  const Json& accessor =
      glb.json["accessors"]
              [glb.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"].get<std::size_t>()];
  const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(glb.bin.data() + view.value("byteOffset", std::size_t{0}) +
                  accessor.value("byteOffset", std::size_t{0}),
              &nan, 4);
  glb.json["meshes"][0]["extras"] = "a text";
  write_bytes(path("nan.glb"), make_glb(glb.json.dump(), glb.bin));
  good("darboux validate nan.glb --paint out.glb", 1);
  EXPECT_EQ(colours("out.glb")[0], grey);
  EXPECT_EQ(split_glb(read_bytes(path("out.glb"))).json["meshes"][0]["extras"], "a text");
}

// Lighter and lighter, so that they are told apart without colours: the luminance of linear RGB.
TEST_F(Cli, PaintColoursAreInOrderOfLightness) {
  good("darboux validate data/torus_016.three.glb --paint out.glb");
  const Json legend = split_glb(read_bytes(path("out.glb"))).json["meshes"][0]["extras"]["darboux"];
  double before = -1;
  for (const Json& c : legend["colours"]) {
    const double luminance =
        0.2126 * c[0].get<double>() + 0.7152 * c[1].get<double>() + 0.0722 * c[2].get<double>();
    EXPECT_GT(luminance, before);
    before = luminance;
    for (const Json& x : c) EXPECT_TRUE(x >= 0.0 && x <= 1.0);
  }
  EXPECT_GT(before, 0.7);
}

TEST_F(Cli, PaintRefusals) {
  const std::string one = "darboux validate data/torus_016.three.glb ";
  refused(one + "data/sphere_016.three.glb --paint out.glb",
          {"--paint", "expected one file to colour, got 2"});
  refused(one + "--paint out.gltf", {"out.gltf", "expected"});
  refused(one + "--paint -", {"standard output", "expected the name of a file"});
  refused(one + "--paint nowhere/out.glb", {"nowhere/out.glb", "expected"});
  refused("darboux validate nowhere.glb --paint out.glb", {"nowhere.glb"});
  EXPECT_FALSE(fs::exists(path("out.glb")));
}

// ---- the page

// The data of the pictures on a page.
std::vector<Json> pictures_on(const std::string& page) {
  const std::string begin = "<script type=\"application/json\">";
  std::vector<Json> result;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at + 1)) {
    const std::size_t from = at + begin.size();
    result.push_back(Json::parse(page.substr(from, page.find("</script>", from) - from)));
  }
  return result;
}

std::size_t triangles_in(const Json& picture) {
  // Four letters hold three bytes; what fills up the last ones is less than an index.
  const std::size_t index = picture["vertices"].get<std::size_t>() <= 0x10000 ? 2 : 4;
  return picture["triangles"].get<std::string>().size() / 4 * 3 / (3 * index);
}

TEST_F(Cli, ReportIsOnePageAndChangesNothingElse) {
  const std::string files = "data/torus_016.three.glb data/mirrortorus_016.mikk.glb data/sphere_016.obj";
  const Result plain = sh("darboux validate --json " + files);
  const Result reported = sh("darboux validate --json " + files + " --report out.html");
  EXPECT_EQ(reported.out, plain.out);
  EXPECT_EQ(reported.status, plain.status);
  const std::string page = read_bytes(path("out.html"));
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  const std::vector<Json> pictures = pictures_on(page);
  ASSERT_EQ(pictures.size(), 3u) << "the mirrored torus has two parts, and one picture";
  std::size_t triangles = 0;
  for (const Json& p : pictures) triangles += triangles_in(p);
  std::size_t corners = 0;
  const Json report = Json::parse(plain.out);
  for (const Json& file : report["files"])
    for (const Json& mesh : file["meshes"]) corners += mesh["corners"].get<std::size_t>();
  EXPECT_EQ(3 * triangles, corners);
}

// Of meshes that are too large for a page some triangles are shown, and the page says how many; small ones
// are whole.
TEST_F(Cli, ReportOfALargeMeshShowsSomeTriangles) {
  good("darboux mesh torus --grid 400x400 -o large.glb");
  good("darboux validate large.glb data/torus_016.three.glb --reference analytic --report out.html --json");
  const std::string page = read_bytes(path("out.html"));
  EXPECT_NE(page.find("Of 320000 triangles every 2nd is drawn."), std::string::npos);
  const std::vector<Json> pictures = pictures_on(page);
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(triangles_in(pictures[0]), 160000u);
  EXPECT_EQ(triangles_in(pictures[1]), 1024u);
}

// What cannot be drawn leaves a page none the less.
TEST_F(Cli, ReportOfMeshesThatCannotBeDrawn) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), most = std::numeric_limits<float>::max();
  const auto write = [&](const char* name, std::initializer_list<float> positions) {
    Builder b;
    b.primitive({{"POSITION", b.positions(positions)}});
    write_bytes(path(name), b.glb());
  };
  write("nan.glb", {nan, nan, nan, 1, 0, 0, 0, 1, 0});
  write("huge.glb", {-most, -most, -most, most, most, 0, most, 0, most});
  write("point.glb", {1, 1, 1, 1, 1, 1, 1, 1, 1});
  Builder lines;
  lines.primitive({{"POSITION", lines.positions({0, 0, 0, 1, 0, 0})}}, {{"mode", 1}});
  write_bytes(path("lines.glb"), lines.glb());
  const Result r = sh("darboux validate nan.glb huge.glb point.glb lines.glb nowhere.glb --report out.html");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
  const std::string page = read_bytes(path("out.html"));
  const std::vector<Json> pictures = pictures_on(page);
  ASSERT_EQ(pictures.size(), 3u);
  EXPECT_EQ(triangles_in(pictures[0]), 0u);
  EXPECT_EQ(triangles_in(pictures[1]), 1u);
  EXPECT_EQ(triangles_in(pictures[2]), 1u);
  EXPECT_EQ(page.find("nan<"), std::string::npos);
  EXPECT_NE(page.find("nowhere.glb"), std::string::npos);
  EXPECT_NE(page.find("mode 1 (lines) has no triangles"), std::string::npos);
}

TEST_F(Cli, ReportRefusals) {
  const std::string one = "darboux validate data/torus_016.three.glb ";
  refused(one + "--report -", {"standard output", "expected the name of a file"});
  refused(one + "--report nowhere/out.html", {"nowhere/out.html", "expected"});
  refused(one + "--report .", {"folder", "expected"});
}

}  // namespace
}  // namespace darboux::test::pictures_test
