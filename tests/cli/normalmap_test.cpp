// `normalmap` by running the tool: what it writes and prints, what it refuses, and that nothing half-written
// is left.
#include <cstring>

#include <darboux/image_files.h>
#include <darboux/io.h>

#include "cli.h"
#include "map_meshes.h"

namespace darboux::test::normalmap_test {
namespace {

class NormalMapCli : public Cli {
 protected:
  NormalMapCli() {
    write_image(path("in.png"), random_directions(40, 30, SampleType::u8, 5));
    write_image(path("in16.png"), random_directions(40, 30, SampleType::u16, 5));
    good("darboux mesh torus --grid 24x12 -o torus.glb");
  }
  // torus.glb, to be changed.
  Builder torus() const {
    const std::string glb = read_bytes(path("torus.glb"));
    std::uint32_t length = 0;
    std::memcpy(&length, glb.data() + 12, 4);
    Builder result;
    result.json = Json::parse(glb.substr(20, length));
    result.bin = glb.substr(28 + length, result.json["buffers"][0]["byteLength"]);
    return result;
  }
  const std::string to_tangent = "darboux normalmap in.png --from object --to tangent --mesh torus.glb ";
};

double worst_difference(const Image& a, const Image& b) {
  double worst = a.samples.index() == b.samples.index() ? 0 : 1e9;
  std::visit(
      [&](const auto& s) {
        const auto* t = std::get_if<std::remove_cvref_t<decltype(s)>>(&b.samples);
        for (std::size_t i = 0; t && i < s.size(); ++i)
          worst = std::fmax(worst, std::fabs(static_cast<double>(s[i]) - static_cast<double>((*t)[i])));
      },
      a.samples);
  return worst;
}

TEST_F(NormalMapCli, ThereAndBack) {
  for (const char* in : {"in.png", "in16.png"}) {
    const std::string there = std::string("darboux normalmap ") + in +
                              " --from object --to tangent --mesh torus.glb --keep-length -o there.png";
    EXPECT_NE(good(there).find("there.png"), std::string::npos);
    good("darboux normalmap there.png --from tangent --to object --mesh torus.glb --keep-length -o back.png");
    EXPECT_LE(worst_difference(read_image(path(in)), read_image(path("back.png"))), 1);
    good(std::string("darboux normalmap ") + in +
         " --from object --to tangent --surface torus --keep-length -o there.exr");
    good(
        "darboux normalmap there.exr --from tangent --to object --surface torus --keep-length --depth 16 -o "
        "back.png");
    const double worst = worst_difference(read_image(path(in)), read_image(path("back.png")));
    EXPECT_TRUE(std::string(in) != "in16.png" || worst == 0) << "EXR holds floats";
  }
  good(to_tangent + "--basis analytic --surface torus -o out.tga");
  EXPECT_EQ(read_image(path("out.tga")).width, 40);
}

TEST_F(NormalMapCli, PrintsJson) {
  const Json j = json(to_tangent + "--green directx --decode gltf-viewer --dilate 2 -o out.png --json");
  expect_keys(
      j, {"texels", "covered", "conflicts", "below_surface", "quantisation_deg", "basis", "decode", "green"});
  EXPECT_EQ(j["texels"], 1200);
  EXPECT_EQ(j["covered"], 1200);
  EXPECT_EQ(j["conflicts"], 0);
  EXPECT_EQ(j["basis"], "stored");
  EXPECT_EQ(j["decode"], "gltf-viewer");
  EXPECT_EQ(j["green"], "directx");
  EXPECT_EQ(j["depth"], "8");
  EXPECT_GT(j["below_surface"], 300) << "of random directions half";
  EXPECT_LT(j["quantisation_deg"]["max"], 0.5);
}

TEST_F(NormalMapCli, AsksWhetherTheMapIsInAnotherSpace) {
  Image flat(40, 30, 3, SampleType::u8);
  auto& codes = std::get<std::vector<std::uint8_t>>(flat.samples);
  for (std::size_t k = 0; k < codes.size(); ++k) codes[k] = k % 3 == 2 ? 255 : 128;
  write_image(path("flat.png"), flat);
  const std::string convert = "darboux normalmap ",
                    object = " --from object --to tangent --mesh torus.glb -o out.png",
                    tangent = " --from tangent --to object --mesh torus.glb -o object.png";
  EXPECT_EQ(good(convert + "flat.png" + tangent).find("is INPUT"), std::string::npos);
  EXPECT_EQ(good(convert + "object.png" + object).find("is INPUT"), std::string::npos);
  EXPECT_NE(good(convert + "flat.png" + object).find("is INPUT a map in object space?"), std::string::npos);
  good("cp object.png in_object_space.png");
  EXPECT_NE(good(convert + "in_object_space.png" + tangent).find("is INPUT a map in tangent space?"),
            std::string::npos);
}

TEST_F(NormalMapCli, RefusesOverlapsWithAPicture) {
  good("darboux mesh torus --grid 24x12 --mirror -o mirrored.glb");
  const std::string command =
      "darboux normalmap in.png --from tangent --to object --mesh mirrored.glb -o out.png --report "
      "where.png ";
  const Json j = json(command + "--json", 1);
  EXPECT_GT(j["conflicts"], 1000);
  EXPECT_EQ(j["output"], nullptr);
  EXPECT_EQ(j["first_conflict"]["texel"].size(), 2u);
  EXPECT_NE(j["first_conflict"]["triangles"][0]["triangle"], j["first_conflict"]["triangles"][1]["triangle"]);
  EXPECT_FALSE(fs::exists(path("out.png")));
  EXPECT_EQ(read_image(path("where.png")).height, 30);
  EXPECT_NE(good(command, 1).find("refused: "), std::string::npos);
}

TEST_F(NormalMapCli, RefusesWhatIsMissingOrContradictsItself) {
  refused("darboux normalmap", {"image"});
  refused("darboux normalmap in.png", {"-o"});
  refused("darboux normalmap in.png -o out.png", {"--from"});
  refused("darboux normalmap in.png -o out.png --from object", {"--to"});
  refused("darboux normalmap in.png -o out.png --from object --to tangent", {"--mesh", "--surface"});
  refused("darboux normalmap in.png -o out.png --from object --to object --mesh torus.glb",
          {"another space"});
  refused("darboux normalmap in.png -o out.png --from object --to world --mesh torus.glb", {"--to"});
  refused(to_tangent + "-o out.jpg", {".png, .tga or .exr"});
  refused(to_tangent + "-o out.tga --depth 16", {"TGA has: 8"});
  refused(to_tangent + "-o in.png", {"-o: expected another file than that of INPUT, got in.png"});
  refused(to_tangent + "-o ./torus.glb", {"torus.glb"});
  refused(to_tangent + "-o out.png --surface torus", {"--basis analytic"});
  refused(to_tangent + "-o out.png --basis analytic", {"--surface"});
  refused(to_tangent + "-o out.png --size 4x4", {"--size: cannot be combined with"});
  refused("darboux normalmap in.png --from object --to tangent --surface torus --wrap clamp -o out.png",
          {"--wrap: cannot be combined with"});
  refused(to_tangent + "-o out.png --primitive x", {"--primitive", "0:1"});
  refused(to_tangent + "-o out.png --primitive 3", {"torus.glb", "named"});
  refused(to_tangent + "-o out.png --two-channels", {"tangent space"});
  refused(to_tangent + "-o out.png --dilate 2000", {"--dilate"});
  refused("darboux normalmap in.png --from world --to object --surface torus -o out.png", {"--mesh"});
  refused("darboux normalmap in.png --from object --to tangent --surface torus --basis stored -o out.png",
          {"--mesh"});
  refused("darboux normalmap in.png --from object --to tangent --mesh data/torus_016.none.glb -o out.png",
          {"tangents", "--basis mikktspace"});
  refused("darboux normalmap missing.png --from object --to tangent --mesh torus.glb -o out.png",
          {"missing.png"});
  refused("darboux normalmap in.png --from object --to tangent --mesh missing.glb -o out.png",
          {"missing.glb"});
  refused("darboux normalmap in.png --from object --to tangent --mesh in16.png -o out.png", {"in16.png"});
  refused(to_tangent + "-o out.png --report out.exr", {"out.exr"});
  refused(to_tangent + "-o missing/out.png", {"missing/out.png"});
  good("ln -s /dev/full full.png");
  refused(to_tangent + "-o full.png", {"full.png"});
  EXPECT_FALSE(fs::exists(path("out.png")));
}

// All uvs in one place cover nothing: that is said, and is no success.
TEST_F(NormalMapCli, AMeshThatCoversNothingFails) {
  good("darboux mesh torus --grid 8x4 --shear 0 -o small.glb");
  const Json j = json(
      "darboux normalmap in.png --from object --to tangent --mesh small.glb --wrap clamp --uv-origin top -o "
      "out.png --json");
  EXPECT_EQ(j["outside_map"], 0);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.tangents.assign(3, {1, 0, 0, 1});
  mesh.uvs.assign(3, {0.5, 0.5});
  mesh.triangles = {{0, 1, 2}};
  write_glb(path("point.glb"), mesh, "point");
  const Json none =
      json("darboux normalmap in.png --from object --to tangent --mesh point.glb -o out.png --json", 1);
  EXPECT_EQ(none["covered"], 0);
  EXPECT_EQ(none["degenerate_uv_triangles"], 1);
  EXPECT_EQ(none["output"], nullptr);
  fs::remove(path("out.png"));
  const std::string text =
      good("darboux normalmap in.png --from object --to tangent --mesh point.glb -o out.png", 1);
  EXPECT_EQ(text.find("rounding"), std::string::npos) << text;
  EXPECT_FALSE(fs::exists(path("out.png")));
}

// Outputs are opened before the work, and the picture is not written where the map cannot be.
TEST_F(NormalMapCli, WritesTheMapBeforeTheReport) {
  good("ln -s /dev/full full.png");
  refused(to_tangent + "-o full.png --report where.png", {"full.png"});
  EXPECT_FALSE(fs::exists(path("where.png")));
  refused("darboux bake --surface torus --mesh torus.glb -o full.png --size 8x8 --report where.png",
          {"full.png"});
  EXPECT_FALSE(fs::exists(path("where.png")));
  // The name is refused though the mesh is not there: it comes first.
  refused("darboux normalmap in.png --from object --to tangent --mesh missing.glb -o missing/out.png",
          {"missing/out.png"});
  refused("darboux bake --surface torus --mesh missing.glb -o missing/out.png", {"missing/out.png"});
  refused("darboux normalmap in.png --from tangent --mesh missing.glb --render missing/out.png",
          {"missing/out.png"});
  refused("darboux normalmap --compare in.png missing.png --report missing/out.png", {"missing/out.png"});
}

// Floats from -1 to 1 taken for 0 to 1 would be wrong by tens of degrees.
TEST_F(NormalMapCli, FloatsSayWhetherTheyAreSigned) {
  const std::string bake = "darboux bake --surface torus --mesh torus.glb --size 64x64 --decode gltf-viewer ",
                    convert = " --from tangent --to object --mesh torus.glb --decode gltf-viewer ";
  for (const std::string flag : {"", "--signed-floats "}) {
    good(bake + flag + "-o t.exr");
    good("darboux normalmap t.exr" + convert + flag + "-o o.exr");
    good("darboux normalmap --compare t.exr t.exr " + flag);
    const std::string way = " --from object --to tangent --surface torus " + flag + "-o ";
    good("darboux normalmap o.exr" + way + "flat.exr");
    // On the surface's own frames its normals are flat: (0, 0, 1), to single precision.
    const Image flat = read_image(path("flat.exr"));
    const double zero = flag.empty() ? 0.5 : 0;
    double worst = 0;
    for (std::size_t i = 0; i < flat.texels(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        worst = std::fmax(worst, std::fabs(std::get<2>(flat.samples)[3 * i + c] - (c < 2 ? zero : 1)));
    EXPECT_LT(worst, 1e-5) << flag;
  }
  const char* const expected = "expected numbers from 0 to 1, or --signed-floats, got -";
  refused("darboux normalmap o.exr" + std::string(" --from object --to tangent --surface torus -o x.exr"),
          {"o.exr", expected});
  refused("darboux normalmap --check o.exr", {"o.exr", expected});
  refused("darboux normalmap --compare o.exr o.exr", {"o.exr", expected});
  refused("darboux normalmap o.exr --from object --mesh torus.glb --render x.png", {"o.exr", expected});
}

// A glTF is a map by its normal texture, and the mesh of that map.
TEST_F(NormalMapCli, TakesTheMapFromAnAsset) {
  Builder asset = torus();
  asset.json["images"] = {
      {{"bufferView", asset.view(read_bytes(path("in.png")))}, {"mimeType", "image/png"}}};
  asset.json["textures"] = {{{"source", 0}}};
  asset.json["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", 0.5}}}}};
  Json& primitives = asset.json["meshes"][0]["primitives"];
  primitives[0]["material"] = 0;
  write_bytes(path("asset.glb"), asset.glb());
  const std::string to_object = " --from tangent --to object ";
  good("darboux normalmap asset.glb" + to_object + "-o one.png");
  good("darboux normalmap in.png" + to_object + "--mesh torus.glb --normal-scale 0.5 -o two.png");
  good("darboux normalmap in.png" + to_object + "--mesh torus.glb -o unscaled.png");
  EXPECT_EQ(read_bytes(path("one.png")), read_bytes(path("two.png")));
  EXPECT_NE(read_bytes(path("one.png")), read_bytes(path("unscaled.png")));
  good("darboux normalmap asset.glb" + to_object + "--mesh asset.glb --normal-scale 1 -o two.png");
  EXPECT_EQ(read_bytes(path("unscaled.png")), read_bytes(path("two.png")));
  good("darboux normalmap asset.glb" + to_object + "--mesh torus.glb -o two.png");
  EXPECT_EQ(read_bytes(path("unscaled.png")), read_bytes(path("two.png"))) << "the other mesh has no scale";
  good("darboux normalmap asset.glb --from tangent --render lit.png");
  Json of_image = json("darboux normalmap --check in.png --json", 1),
       of_asset = json("darboux normalmap --check asset.glb --primitive 0 --json", 1);
  of_image.erase("file"), of_asset.erase("file");
  EXPECT_EQ(of_image, of_asset);
  good("darboux normalmap --compare in.png asset.glb --max-angle 0");
  refused("darboux normalmap asset.glb" + to_object + "-o asset.glb", {"asset.glb"});
  refused("darboux normalmap torus.glb" + to_object + "-o x.png",
          {"torus.glb: expected normal textures of one image", "got none"});
  refused("darboux normalmap asset.glb" + to_object + "--normal-scale 0 -o x.png", {"--normal-scale"});
  // A second primitive with another image.
  asset.json["images"].push_back({{"uri", "in16.png"}});
  asset.json["textures"].push_back({{"source", 1}});
  asset.json["materials"].push_back({{"normalTexture", {{"index", 1}}}});
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = 1;
  write_bytes(path("asset.glb"), asset.glb());
  refused("darboux normalmap asset.glb" + to_object + "-o x.png", {"--primitive", "got images 0, 1"});
  // --primitive does not choose of these.
  for (const std::string& command :
       {"asset.glb" + to_object + "--mesh torus.glb -o x.png", std::string("--compare in.png asset.glb")})
    refused("darboux normalmap " + command,
            {"asset.glb: expected normal textures of one image, got images 0, 1"});
  refused("darboux normalmap --check asset.glb", {"--primitive", "got images 0, 1"});
  good("darboux normalmap asset.glb --primitive 0:1" + to_object + "-o two.png");
  good("darboux normalmap in16.png" + to_object + "--mesh torus.glb -o one.png");
  EXPECT_EQ(read_bytes(path("one.png")), read_bytes(path("two.png")));
  EXPECT_FALSE(fs::exists(path("x.png")));
}

// No output takes the place of what is read, be it by the name that a glTF gives it.
TEST_F(NormalMapCli, OverwritesNothingThatItReads) {
  Builder asset = torus();
  asset.json["images"] = {{{"uri", "textures/%6E.png"}}};
  asset.json["textures"] = {{{"source", 0}}};
  asset.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
  asset.json["meshes"][0]["primitives"][0]["material"] = 0;
  const std::string model = asset.glb(), map = read_bytes(path("in.png"));
  for (const char* name : {"asset.glb", "asset.png"}) write_bytes(path(name), model);
  good("mkdir textures; cp in.png textures/n.png; ln -s textures/n.png link.png");
  const std::string other = "expected another file than that of ",
                    render = "darboux normalmap in.png --from tangent --mesh asset.png --size 8x8 --render ",
                    convert = "darboux normalmap asset.glb --from tangent --to object ";
  refused(render + "in.png", {"--render: " + other + "INPUT, got in.png"});
  refused(render + "./asset.png", {"--render: " + other + "--mesh, got ./asset.png"});
  refused("darboux normalmap asset.glb --from tangent --size 8x8 --render textures/n.png",
          {"--render: " + other + "the image of INPUT, got textures/n.png"});
  for (const std::string name : {"textures/n.png", "link.png"})
    refused(convert + "-o " + name, {"-o: " + other + "the image of INPUT, got " + name});
  refused(convert + "-o x.png --report textures/n.png", {"--report: " + other + "the image of INPUT"});
  refused("darboux normalmap --compare in.png asset.glb --report textures/n.png",
          {"--report: " + other + "the image of --compare"});
  for (const char* name : {"in.png", "textures/n.png"}) EXPECT_EQ(read_bytes(path(name)), map) << name;
  EXPECT_EQ(read_bytes(path("asset.png")), model);
  EXPECT_FALSE(fs::exists(path("x.png")));
}

// What is decoded and made counts.
TEST_F(NormalMapCli, KeepsWithinTheMemoryThatItMayTake) {
  const std::string bake = "darboux bake --surface torus --mesh torus.glb -o b.png --size ";
  refused(bake + "4000x4000 --max-memory 10MB", {"b.png: expected at most ", "a map of 16000000 texels"});
  refused(bake + "65536x65536", {"a map of 4294967296 texels"});
  refused(bake + "16000x16000", {"--max-memory"});
  EXPECT_FALSE(fs::exists(path("b.png")));
  good(bake + "800x600");
  const std::string convert = "darboux normalmap b.png --from tangent --to object --mesh torus.glb -o o.png ";
  refused(convert + "--max-memory 1MB", {"b.png: expected at most ", "an image of 800 x 600"});
  refused(convert + "--max-memory 2MB", {"b.png: expected at most ", "a map of 480000 texels"});
  EXPECT_FALSE(fs::exists(path("o.png")));
  good(convert + "--max-memory 6MB");
  refused("darboux normalmap --check b.png --max-memory 1MB", {"an image of 800 x 600"});
}

// ---- bake, check, compare ---------------------------------------------------------------------------------

TEST_F(NormalMapCli, BakesAndTellsTheErrorThatIsLeft) {
  good("darboux mesh torus --grid 12x6 -o low.glb");
  const std::string bake = "darboux bake --surface torus --mesh low.glb --size 128x96 -o normal.png ";
  const Json j = json(bake + "--json");
  expect_keys(j,
              {"file", "surface", "texels", "covered", "bound_deg", "quantisation_deg", "error", "classes"});
  EXPECT_EQ(j["texels"], 128 * 96);
  EXPECT_LT(j["error"]["with_map_deg"]["rms"], j["error"]["without_map_deg"]["rms"].get<double>() / 5);
  EXPECT_LT(j["quantisation_deg"]["max"], j["bound_deg"]);
  std::size_t samples = 0;
  for (const Json& c : j["classes"]) samples += c["samples"].get<std::size_t>();
  EXPECT_EQ(samples, j["error"]["samples"]);
  EXPECT_EQ(read_image(path("normal.png")).height, 96);
  EXPECT_NE(good(bake).find("interior"), std::string::npos);
  EXPECT_EQ(good(bake + "--samples 0").find("without the map"), std::string::npos) << "no empty table";
  refused("darboux bake", {"--surface"});
  refused("darboux bake --surface torus -o normal.png", {"--mesh"});
  refused("darboux bake --surface torus --mesh low.glb", {"-o"});
  refused(bake + "--size 0x4", {"--size"});
  refused(bake + "--basis analytic", {"--basis"});
  refused("darboux bake --surface torus --mesh low.glb -o low.glb", {"low.glb"});
}

// The surface's place and what the uvs mean are found, its parameters are not.
TEST_F(NormalMapCli, BakesOnlyAMeshOfTheSurface) {
  good("darboux mesh ellipsoid:semi_axis_x=3 --grid 24x12 -o e.glb");
  const std::string bake = "darboux bake --mesh e.glb --size 32x32 -o e.png --surface ellipsoid";
  EXPECT_LT(json(bake + ":semi_axis_x=3 --json")["rms_relative"], 1e-6);
  fs::remove(path("e.png"));
  refused(bake, {"e.glb: expected a mesh of the surface",
                 "as in --surface ellipsoid:semi_axis_x=3, got one that is off it by ", " % of its size"});
  EXPECT_FALSE(fs::exists(path("e.png")));
  // Where a surface has no value it says nothing of the mesh.
  test::write_bytes(path("part.surface"), "x = u\ny = v\nz = 5 + log(u - 0.3)\n");
  refused("darboux bake --mesh e.glb --size 32x32 -o e.png --surface formula:file=part.surface",
          {"expected a mesh of the surface"});
  test::write_bytes(path("none.surface"), "x = u\ny = v\nz = log(-1)\n");
  refused("darboux bake --mesh e.glb --size 32x32 -o e.png --surface formula:file=none.surface",
          {"expected a mesh of the surface", "got one at whose uvs the surface has no value"});
  good("darboux mesh torus --grid 24x12 --shear 1 -o sheared.glb");
  EXPECT_NE(good("darboux bake --mesh sheared.glb --size 32x32 -o s.png --surface torus").find("uvs affine"),
            std::string::npos);
}

// ---- validate --normal-map
// ---------------------------------------------------------------------------------

TEST_F(NormalMapCli, RefusesAMapToWeighThatIsTooLarge) {
  const std::string weigh = "darboux validate torus.glb --surface torus --json --normal-map ";
  refused(weigh + "16385x16384", {"--normal-map: expected 1 to 2^28 texels, got 16385 x 16384"});
  refused(weigh + "1000000000x1000000000", {"--normal-map: expected 1 to 2^28 texels"});
  refused(weigh + "512x512 --max-memory 9MB", {"--normal-map: expected at most ", "a map of 262144 texels"});
  refused("darboux validate missing.glb --normal-map 16384x16384 --max-memory 1GB", {"--normal-map: "});
  const Json j = json(weigh + "64x64 --max-memory 9MB");
  EXPECT_GT(j["files"][0]["meshes"][0]["normal_map"]["samples"], 0);
}

// What no triangle of a part has, another part's vertices among it, is not looked at.
TEST_F(NormalMapCli, WeighsTrianglesAlone) {
  Mesh mesh = read_asset(path("torus.glb")).primitives[0].data;
  const std::string weigh = "darboux validate torus.glb --surface torus --normal-map 64x64 --json";
  const Json wanted = json(weigh)["files"][0]["meshes"][0]["normal_map"];
  mesh.positions.insert(mesh.positions.begin(), mesh.positions[0]);
  mesh.normals.insert(mesh.normals.begin(), mesh.normals[0]);
  mesh.tangents.insert(mesh.tangents.begin(), mesh.tangents[0]);
  mesh.uvs.insert(mesh.uvs.begin(), {NAN, 7.4});
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) ++v;
  write_glb(path("torus.glb"), mesh, "torus");
  const Result r = sh(weigh);
  EXPECT_EQ(Json::parse(r.out)["files"][0]["meshes"][0]["normal_map"], wanted) << r.err;
}

TEST_F(NormalMapCli, ChecksAMapSeenAlone) {
  const Json j = json("darboux normalmap --check in.png --json", 1);
  EXPECT_EQ(j["green"], "undecided");
  EXPECT_EQ(j["not_unit"], 0);
  EXPECT_FALSE(j["ok"]);
  ASSERT_EQ(j["findings"].size(), 1u);
  EXPECT_EQ(j["findings"][0]["code"], "BELOW_SURFACE");
  good(
      "darboux mesh torus --grid 24x12 -o low.glb; darboux bake --surface torus --mesh low.glb --size 64x64 "
      "-o b.png");
  // A hill: the codes of h = exp(-r²).
  Image hill(64, 64, 3, SampleType::u8);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double u = (x - 31.5) / 16, w = -(y - 31.5) / 16, e = std::exp(-u * u - w * w);
      const double p = -2 * u * e, q = -2 * w * e, length = std::sqrt(1 + p * p + q * q);
      const double n[3] = {-p / length, -q / length, 1 / length};
      for (std::size_t c = 0; c < 3; ++c)
        std::get<0>(hill.samples)[static_cast<std::size_t>(3 * (64 * y + x)) + c] =
            static_cast<std::uint8_t>(std::floor((n[c] + 1) / 2 * 255 + 0.5));
    }
  write_image(path("hill.png"), hill);
  EXPECT_EQ(json("darboux normalmap --check hill.png --json")["green"], "opengl");
  const Json wrong = json("darboux normalmap --check hill.png --green directx --json", 1);
  EXPECT_EQ(wrong["findings"][0]["code"], "GREEN");
  EXPECT_NE(good("darboux normalmap --check hill.png").find("nothing wrong"), std::string::npos);
  refused("darboux normalmap --check missing.png", {"missing.png"});
  refused("darboux normalmap --check in.png -o out.png", {"--output", "--check"});
  refused("darboux normalmap --check in.png --compare in.png in.png", {"--compare"});
  for (const std::string option : {"--wrap clamp", "--decode mikktspace", "--primitive 0", "--sign raw",
                                   "--uv-origin top", "--size 4x4", "--normal-scale 2"})
    refused("darboux normalmap --check in.png " + option,
            {option.substr(0, option.find(' ')) + ": cannot be combined with --check"});
}

TEST_F(NormalMapCli, DrawsTheModelLitThroughEitherMap) {
  good(
      "darboux mesh torus --grid 24x12 -o low.glb; darboux bake --surface torus --mesh low.glb --size "
      "512x512 -o t.png");
  good("darboux normalmap t.png --from tangent --to object --mesh low.glb --decode gltf-viewer -o o.png");
  const std::string size = " --mesh low.glb --size 120x90 --render ";
  good("darboux normalmap t.png --from tangent" + size + "lit_t.png");
  good("darboux normalmap o.png --from object" + size + "lit_o.png");
  const ReadImageOptions pictures{.drop_colour_tags = true};
  const Image one = read_image(path("lit_t.png"), pictures), other = read_image(path("lit_o.png"), pictures);
  EXPECT_EQ(one.width, 120);
  EXPECT_LE(worst_difference(one, other), 4) << "codes of 8 bits: tests/report/lit_model_test.cpp";
  EXPECT_EQ(json("darboux normalmap o.png --from object" + size + "lit_o.png --json"),
            (Json{{"file", "o.png"}, {"render", "lit_o.png"}, {"from", "object"}, {"green", "opengl"}}));
  refused("darboux normalmap t.png --from world" + size + "x.png", {"--render", "--from tangent or object"});
  refused("darboux normalmap t.png --from tangent --to object" + size + "x.png", {"--to", "--render"});
  refused("darboux normalmap t.png --from tangent --decode mikktspace" + size + "x.png",
          {"--decode: cannot be combined with --render"});
  refused("darboux normalmap t.png --from tangent --basis analytic" + size + "x.png", {"--basis"});
  refused("darboux normalmap t.png --from tangent" + size + "x.tga", {".png"});
}

TEST_F(NormalMapCli, ComparesTwoMaps) {
  const Json j =
      json("darboux normalmap --compare in.png in16.png --mesh torus.glb --report heat.png --json");
  EXPECT_EQ(j["compared"], 1200);
  EXPECT_GT(j["angle_deg"]["max"], 0);
  EXPECT_LT(j["angle_deg"]["max"], 0.4);
  EXPECT_EQ(j["islands"].size(), 1u);
  EXPECT_EQ(j["worst"].size(), 10u);
  EXPECT_TRUE(j["same"]);
  EXPECT_EQ(read_image(path("heat.png")).width, 40);
  EXPECT_FALSE(json("darboux normalmap --compare in.png in16.png --max-angle 0.01 --json", 1)["same"]);
  EXPECT_NE(good("darboux normalmap --compare in.png in.png --max-angle 0").find("1200 texels"),
            std::string::npos);
  // Without a limit of the user's: what the rounding of 8 bits explains is the same, another map is not.
  const Image map = read_image(path("in.png"));
  Image turned = map;
  auto& samples = std::get<0>(turned.samples);
  for (std::size_t i = 0; i < samples.size(); i += 3) std::swap(samples[i], samples[i + 1]);
  write_image(path("turned.png"), turned);
  EXPECT_FALSE(json("darboux normalmap --compare in.png turned.png --json", 1)["same"]);
  EXPECT_NE(
      sh("darboux normalmap --compare in.png turned.png").out.find("not the same: over --max-angle 1\n"),
      std::string::npos);
  const std::vector<std::string> rows =
      lines(good("darboux normalmap --compare in.png in.png --mesh torus.glb"));
  EXPECT_EQ(rows.at(2), "  mesh 0 island 0           1200        0        0        0");
  EXPECT_EQ(rows.at(3), "  all                       1200        0        0        0");
  write_image(path("small.png"), Image(8, 8, 3, SampleType::u8));
  refused("darboux normalmap --compare in.png small.png", {"40 x 30 and 8 x 8"});
  refused("darboux normalmap --compare in.png", {"--compare"});
  refused("darboux normalmap --compare in.png in16.png --max-angle nan",
          {"--max-angle", "0 to 180", "'nan'"});
  for (const std::string option : {"--primitive 0", "--sign raw", "--size 4x4", "--wrap clamp"})
    refused("darboux normalmap --compare in.png in16.png " + option,
            {option.substr(0, option.find(' ')) + ": cannot be combined with --compare"});
  refused("darboux normalmap --compare in.png in16.png --report in.png", {"in.png"});
  refused("darboux normalmap in.png --max-angle 3 --from object --to tangent --mesh torus.glb -o out.png",
          {"--max-angle"});
}

}  // namespace
}  // namespace darboux::test::normalmap_test
