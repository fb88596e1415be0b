#include "validate_pictures.h"

#include <cmath>
#include <limits>

#include "base/text.h"
#include "io/files.h"
#include "report/colour_map.h"
#include "validate_page.h"

namespace darboux {
namespace {

// The meaning of a mesh's colours, for its extras.
std::string legend(const AssessedFile& file, std::size_t mesh, double max_angle_deg) {
  bool tangents = false, normals = false;
  for (const AssessedPrimitive& p : file.primitives)
    if (p.primitive.mesh == mesh) (p.primitive.data.tangents.empty() ? normals : tangents) = true;
  const auto rgb = [](const Vec3<float>& c) { return Json{c.x, c.y, c.z}; };
  Json colours = Json::array();
  for (const Vec3<float>& c : viridis()) colours.push_back(rgb(c));
  return Json{{"darboux",
               {{"paint", !normals    ? "tangent error"
                          : !tangents ? "normal error"
                                      : "tangent error; normal error where a primitive has no tangents"},
                {"unit", "deg"},
                {"from", 0},
                {"to", max_angle_deg},
                {"colours", colours},
                {"not compared", rgb(not_compared)}}}}
      .dump();
}

void paint(const AssessedFile& file, double max_angle_deg, const std::string& path, const ReadOptions& read) {
  GltfDocument document = [&] {
    if (io::is_gltf(file.path)) return GltfDocument::load(file.path, read);
    Asset asset;
    for (const AssessedPrimitive& p : file.primitives) asset.primitives.push_back(p.primitive);
    return GltfDocument::of(asset, file.path);
  }();
  // As assessed: the document has the same primitives in the same order.
  const Asset asset = document.asset();
  for (std::size_t k = 0; k < file.primitives.size(); ++k) {
    const AssessedPrimitive& assessed = file.primitives[k];
    std::vector<Vec3<float>> colours;
    for (const float error : vertex_errors(assessed)) colours.push_back(colour_of(error, max_angle_deg));
    document.set_colours(asset.primitives.at(k).mesh, asset.primitives.at(k).primitive, colours,
                         legend(file, assessed.primitive.mesh, max_angle_deg));
  }
  document.save_glb(path);
}

// \throws whatever opening an output file there would throw
void check_writable(const std::string& path) {
  const OutputFile opened_and_dropped{path};
}

}  // namespace

std::vector<float> vertex_errors(const AssessedPrimitive& assessed) {
  const Mesh& mesh = assessed.primitive.data;
  std::vector<float> errors(mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (const Assessment& j : assessed.assessments)
    for (std::size_t c = 0; c < j.report.errors_deg.size(); ++c) {
      const std::size_t triangle = j.triangles.empty() ? c / 3 : j.triangles[c / 3];
      float& error = errors[mesh.triangles[triangle][c % 3]];
      error = std::fmax(error, j.report.errors_deg[c]);
    }
  return errors;
}

void add_pictures(CLI::App& sub, Pictures& pictures) {
  sub.add_option("--paint", pictures.paint,
                 "write this .glb: the mesh with vertices coloured by error, from 0 to --max-angle");
  sub.add_option("--report", pictures.page, "write this .html: the verdict with pictures");
}

void check_pictures(const Pictures& pictures, std::size_t files) {
  if (is_standard_output(pictures.paint) || is_standard_output(pictures.page))
    throw ParameterError("-", expected_got("the name of a file", "-: standard output has the verdict"));
  if (!pictures.page.empty()) check_writable(pictures.page);
  known_extension("--report", pictures.page, {".html", ".htm"});
  if (pictures.paint.empty()) return;
  check_writable(pictures.paint);
  check_glb_name(pictures.paint);
  if (files != 1) throw ParameterError("--paint", expected_got("one file to colour", std::to_string(files)));
}

void write_pictures(const Pictures& pictures, const std::vector<AssessedFile>& files, double max_angle_deg,
                    const ReadOptions& read) {
  if (!pictures.paint.empty() && files.front().readable())
    paint(files.front(), max_angle_deg, pictures.paint, read);
  if (!pictures.page.empty()) write_file(pictures.page, validate_page(files, max_angle_deg));
}

}  // namespace darboux
