// A NURBS patch in C++: clamped knots, weights, and what its file would say.
#include <cstdio>
#include <vector>

#include <darboux/bspline_patch.h>
#include <darboux/curvature.h>
#include <darboux/evaluate.h>

int main() {
  // A quarter of a cylinder of radius 2 and height 3: a circle's arc is a rational curve of degree 2 whose
  // middle control point has the weight cos(45°).
  const double w = 0.70710678118654752;
  const std::vector<darboux::Vec3<double>> points{
      {2, 0, 0}, {2, 0, 3},  // P_00, P_01: u runs from row to row,
      {2, 2, 0}, {2, 2, 3},  // v along each
      {0, 2, 0}, {0, 2, 3}};
  const std::vector<double> weights{1, 1, w, w, 1, 1};
  // Clamped: the patch begins and ends in its first and last control points.
  const darboux::BSplinePatch<> patch(2, 1, darboux::clamped_knots(2, 3), darboux::clamped_knots(1, 2),
                                      points, weights);

  const darboux::Jet2<double> jet = darboux::jet(patch, 0.5, 0.5);
  const darboux::Frame<double> f = frame(patch, 0.5, 0.5);
  std::printf("position  %.15g %.15g %.15g\n", jet.position.x, jet.position.y, jet.position.z);
  std::printf("normal    %.15g %.15g %.15g\n", f.n.x, f.n.y, f.n.z);
  const darboux::Curvature<double> c = curvature(patch, 0.5, 0.5);
  std::printf("curvature %.15g %.15g\n", c.principal[0], c.principal[1]);
}
