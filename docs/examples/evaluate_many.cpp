// Many points at once: a grid into arrays, and into an array of structs, with the statuses counted.
#include <cstdio>
#include <vector>

#include <darboux/evaluate.h>
#include <darboux/sphere.h>

struct Vertex {
  float position[3];
  float uv[2];
  float tangent[4];
};

int main() {
  const darboux::Sphere sphere{2.0};  // v from pole to pole
  using darboux::Attribute;

  // Arrays of one's own points, in double: one array per component, or packed vectors.
  const std::vector<double> u{0.125, 0.25, 0.375}, v{0.625, 0.75, 1.0};
  std::vector<double> x(3), y(3), z(3), normals(3 * 3);
  std::vector<darboux::Status> status(3);
  darboux::Outputs<double> arrays;
  arrays.separate(Attribute::position, {x, y, z}).packed(Attribute::normal, normals).status(status);
  evaluate(sphere, darboux::Points<double>::arrays(u, v), arrays);
  for (std::size_t i = 0; i < u.size(); ++i)
    std::printf("%g %g: z %.15g, n_z %.15g, %s\n", u[i], v[i], z[i], normals[3 * i + 2],
                has(status[i], darboux::Status::dpdu_zero) ? "pole" : "regular");

  // A vertex buffer in float over 1024 x 512 cells. Members that are not named (uv) are left alone.
  const auto grid = darboux::Points<float>::grid(1024, 512);
  std::vector<Vertex> vertices(grid.size());
  darboux::Outputs<float> members;
  members.member(Attribute::position, vertices[0].position, vertices.size(), sizeof(Vertex))
      .member(Attribute::tangent4, vertices[0].tangent, vertices.size(), sizeof(Vertex));
  const darboux::StatusSummary summary = evaluate(sphere, grid, members, {.threads = 0});  // all there are
  const Vertex& last = vertices[512 * 1025];
  std::printf("%zu vertices, the north pole at %g %g %g, w %+g\n", summary.points, last.position[0],
              last.position[1], last.position[2], last.tangent[3]);
  for (std::size_t k = 0; k < summary.count.size(); ++k)
    if (summary.count[k] > 0)
      std::printf("%s: %zu, first %zu\n", std::string(darboux::status_names[k]).c_str(), summary.count[k],
                  summary.first[k]);
}
