// What the tool says of files that it cannot read: one line with the file's name, whatever the file holds and
// however it is called.
#include <regex>

#include <darboux/image_files.h>

#include "base/text.h"
#include "cli.h"
#include "thinning.h"

namespace darboux::test::messages_test {
namespace {

// A command that reads FILE, of a name that ends so.
struct Reading {
  const char *command, *extension;
};

constexpr Reading readings[] = {
    {"eval sphere --input FILE", ".csv"},
    {"eval sphere --input FILE", ".npy"},
    {"eval sphere --input FILE", ".json"},
    {"eval sphere --input FILE", ".f64"},
    {"eval formula:file=FILE --at 0,0", ".surface"},
    {"eval bezier-patch:file=FILE --at 0,0", ".json"},
    {"validate FILE", ".glb"},
    {"validate FILE", ".gltf"},
    {"validate FILE", ".ply"},
    {"validate FILE", ".stl"},
    {"validate FILE", ".obj"},
    {"validate FILE", ".fbx"},
    {"validate FILE", ".dae"},
    {"validate FILE", ".nothing"},
    {"validate FILE --json", ".glb"},
    {"validate data/torus_016.three.glb --baseline FILE", ".json"},
    {"validate data/torus_016.three.glb --config FILE", ".toml"},
    {"validate data/torus_016.three.glb --surface formula:file=FILE", ".surface"},
    {"plan FILE", ".glb"},
    {"plan FILE --splits", ".gltf"},
    {"plan data/torus_016.three.glb --against FILE", ".glb"},
    {"tangents FILE -o out.glb", ".glb"},
    {"tangents FILE -o out.glb", ".gltf"},
    {"compare FILE data/torus_016.three.glb", ".glb"},
    {"compare data/torus_016.three.glb FILE", ".ply"},
    {"fit FILE", ".xyz"},
    {"fit FILE", ".csv"},
    {"fit FILE", ".ply"},
    {"fit FILE", ".pcd"},
    {"fit FILE", ".stl"},
    {"fit FILE", ".obj"},
    {"fit FILE", ".glb"},
    {"normalmap FILE --from object --to tangent --surface torus -o out.png", ".png"},
    {"normalmap FILE --from object --to tangent --surface torus -o out.png", ".tga"},
    {"normalmap FILE --from object --to tangent --surface torus -o out.png", ".exr"},
    {"normalmap normal.png --from object --to tangent --mesh FILE -o out.png", ".ply"},
    {"normalmap FILE --from tangent --to object -o out.png", ".gltf"},
    {"normalmap --check FILE", ".glb"},
    {"bake --surface torus --mesh FILE --size 8x8 -o out.png", ".ply"},
    {"scene FILE", ".json"},
    {"scene FILE", ".gltf"},
    {"converge --study FILE", ".json"},
    {"converge --surfaces torus --methods face --resolutions 4,6,8 --results FILE", ".jsonl"},
    {"merge FILE", ".jsonl"},
};

std::vector<std::string> contents() {
  const std::string large(1000000, 'x'), no_text = "\xff\xfe\x01\x1b[31m\xc3(\n\xed\xa0\x80";
  return {"",
          "nonsense",
          no_text,
          large,
          "{}",
          "[]",
          "{\"" + large + "\": 1}",
          "{\"\": \"" + large + "\"}",
          "{\"files\": [{\"file\": \"data/torus_016.three.glb\", \"verdict\": \"" + large + "\"}]}",
          "{\"files\": 1e999, \"surfaces\": 1e999}",
          R"({"asset": {"version": ")" + large + R"("}})",
          R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": ")" + large + R"("}]})",
          R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "a%00%ff%0a"}]})",
          R"({"asset": {"version": "2.0"}, "extensionsRequired": [")" + large + R"("], "meshes": 3})",
          "x = " + large,
          large + " = \"\n[" + large,
          "ply\nformat " + large + "\n",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",  // without uvs
          "# .PCD v0.7\nFIELDS " + large + "\n",
          "u,v\n" + no_text + "\n",
          "u,v\n1," + large + "\n"};
}

class Messages : public Cli {
 protected:
  Messages() { write_image(path("normal.png"), Image(4, 4, 3, SampleType::u8)); }

  // The law for all that stands on stderr.
  static void check(const Result& r, const std::string& file) {
    static const std::regex forbidden("exception|basic_|filebuf|std::|terminate|nlohmann");
    for (const std::string& line : lines(r.err)) {
      EXPECT_TRUE(line.starts_with("darboux: ")) << line.substr(0, 1000);
      EXPECT_LE(line.size(), 500u) << line.substr(0, 1000);
      EXPECT_EQ(one_line(line), line);  // UTF-8 without control characters
      EXPECT_FALSE(std::regex_search(line, forbidden)) << line;
      EXPECT_FALSE(line.starts_with("darboux: :") || line.find(": : ") != std::string::npos) << line;
    }
    if (r.status != 2) return;
    EXPECT_EQ(lines(r.err).size(), 1u) << r.err.substr(0, 1000);
    const std::string name = one_line(file.substr(file.rfind('/') + 1));  // the end of a long one
    EXPECT_NE(r.err.find(name), std::string::npos) << r.err.substr(0, 1000);
  }

  // \param turn where the choice among the contents begins (thinning.h)
  void check_all(const std::string& stem, const std::vector<std::string>& all_contents, int turn = 0) {
    for (const Reading& reading : readings) {
      int combination = turn++;
      const std::string file = stem + reading.extension;
      std::string command = std::string("darboux ") + reading.command;
      command.replace(command.find("FILE"), 4, "\"$FILE\"");
      for (const std::string& content : all_contents) {
        if (!is_taken(combination++)) continue;
        write_bytes(path(file), content);
        SCOPED_TRACE(command + " with " + one_line(content.substr(0, 100)));
        check(sh("FILE='" + file + "'; " + command), file);
        fs::remove(path(file));
        if (HasFailure()) break;
      }
      SCOPED_TRACE(command + " with no file, then a folder");
      const Result none = sh("FILE='" + file + "'; " + command);
      const bool made = std::string_view(reading.command).ends_with("--results FILE");
      EXPECT_EQ(none.status, made ? 0 : 2) << none.out;
      check(none, file);
      fs::remove(path(file));
      fs::create_directory(path(file));
      const Result folder = sh("FILE='" + file + "'; " + command);
      EXPECT_EQ(folder.status, 2) << folder.out;
      check(folder, file);
      fs::remove(path(file));
    }
  }
};

TEST_F(Messages, AreOneLineWithTheNameWhateverTheFileHolds) {
  check_all("file", contents());
}

TEST_F(Messages, AreOneLineHoweverTheFileIsCalled) {
  std::string folders;
  for (int i = 0; i < 8; ++i) folders += std::string(100, static_cast<char>('a' + i)) + '/';
  fs::create_directories(path(folders));
  int turn = 0;
  for (const std::string& stem : {std::string("\xff\xc3(\x1b[31m\n\xe2\x80\xae"), folders + "\xc3\xa9"})
    check_all(stem, {"", "nonsense", "{}"}, turn++);
}

// What a user types may be as long, and hold as much.
TEST_F(Messages, OfTheCommandLineAreOneLineToo) {
  const std::string text = std::string(30000, 'x') + "\xff\n\x1b";
  for (const std::string command : {"eval TEXT --at 0,0",
                                    "eval sphere --at TEXT",
                                    "eval sphere --TEXT",
                                    "eval sphere --at 0,0 --format TEXT",
                                    "eval sphere --at 0,0 --attributes TEXT",
                                    "eval sphere:TEXT=1 --at 0,0",
                                    "eval sphere:radius=TEXT --at 0,0",
                                    "mesh sphere --grid TEXT -o x",
                                    "check TEXT",
                                    "converge --methods TEXT",
                                    "validate --severity TEXT x.glb",
                                    "tangents data/torus_016.none.glb -o x.glb --method TEXT",
                                    "TEXT",
                                    "surfaces --pages data/TEXT",
                                    "mesh sphere --grid 4x4 -o TEXT",
                                    "mesh sphere --grid 4x4 -o ''",
                                    "eval '' --at 0,0",
                                    "validate ''",
                                    "fit ''",
                                    "scene ''",
                                    "merge ''",
                                    "tangents '' -o x.glb",
                                    "plan ''",
                                    "compare '' ''",
                                    "eval formula:file= --at 0,0",
                                    "converge --study ''",
                                    "validate --config '' data/torus_016.three.glb",
                                    "validate --baseline '' data/torus_016.three.glb"}) {
    SCOPED_TRACE(command);
    std::string typed = "darboux " + command;
    if (const std::size_t at = typed.find("TEXT"); at != std::string::npos) typed.replace(at, 4, "\"$TEXT\"");
    const Result r = sh("TEXT='" + text + "'; " + typed);
    EXPECT_EQ(r.status, 2);
    EXPECT_EQ(lines(r.err).size(), 1u);
    check({0, r.out, r.err}, "");
  }
}

}  // namespace
}  // namespace darboux::test::messages_test
