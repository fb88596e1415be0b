#include "second_normal_map.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <boost/multiprecision/cpp_int.hpp>

namespace darboux::test {
namespace {

using Rational = boost::multiprecision::cpp_rational;

}

double SecondFrame::condition() const {
  const auto values = Eigen::JacobiSVD<Eigen::Matrix3d>(columns).singularValues();
  return values[0] / values[2];
}

SecondNormalMap::SecondNormalMap(const MapPiece& piece, const NormalMapOptions& options, int width,
                                 int height)
    : piece_(piece), options_(options), width_(width), height_(height) {
  if (options.basis == MapBasis::mikktspace)
    frames_ = mesh_frames(piece.mesh, find_frame_method("mikktspace"));
}

std::vector<SecondFrame> SecondNormalMap::frames(int x, int y) const {
  std::vector<SecondFrame> result;
  for (std::size_t i = 0; i < piece_.mesh.triangles.size(); ++i)
    if (covers(i, x, y)) result.push_back({i, frame(i, x, y)});
  return result;
}

Eigen::Vector3d SecondNormalMap::convert(const Eigen::Vector3d& codes, double most,
                                         const Eigen::Matrix3d& m) const {
  Eigen::Vector3d in = (codes / most).array() * 2 - 1;
  const double flip = options_.green == MapGreen::directx ? -1 : 1;
  if (options_.from == MapSpace::tangent) in.y() *= flip;
  Eigen::Vector3d out = options_.to == MapSpace::object ? (m * in).eval() : m.fullPivLu().solve(in).eval();
  out.normalize();
  if (options_.keep_length) out *= in.norm();
  if (options_.to == MapSpace::tangent) out.y() *= flip;
  return out;
}

std::array<std::array<double, 2>, 3> SecondNormalMap::corners(std::size_t i) const {
  std::array<std::array<double, 2>, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& uv = piece_.mesh.uvs[piece_.mesh.triangles[i][k]];
    p[k] = {uv.x * width_, (piece_.v_up ? 1 - uv.y : uv.y) * height_};
  }
  return p;
}

// Inside, or on an edge that is a left or lower one of the triangle: half of the edges through a point are.
bool SecondNormalMap::covers(std::size_t i, int x, int y) const {
  const auto p = corners(i);
  for (std::size_t a = 0; a < 2; ++a) {
    const double at = (a == 0 ? x : y) + 0.5;
    if (at < std::min({p[0][a], p[1][a], p[2][a]}) || at > std::max({p[0][a], p[1][a], p[2][a]}))
      return false;
  }
  const auto side = [&](std::size_t k, const Rational& px, const Rational& py) -> Rational {
    const auto &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    const Rational dx = Rational(b[0]) - Rational(a[0]), dy = Rational(b[1]) - Rational(a[1]);
    return dx * (py - Rational(a[1])) - dy * (px - Rational(a[0]));
  };
  const Rational area = side(2, Rational(p[2][0]), Rational(p[2][1]));
  if (area == 0) return false;
  const int sign = area > 0 ? 1 : -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Rational e = sign * side(k, Rational(x + 0.5), Rational(y + 0.5));
    if (e < 0) return false;
    const auto &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    const double dx = sign * (b[0] - a[0]), dy = sign * (b[1] - a[1]);
    if (e == 0 && !(dy > 0 || (dy == 0 && dx < 0))) return false;
  }
  return true;
}

Eigen::Matrix3d SecondNormalMap::frame(std::size_t i, int x, int y) const {
  const auto p = corners(i);
  Eigen::Matrix3d system;
  for (int k = 0; k < 3; ++k)
    system.col(k) << p[static_cast<std::size_t>(k)][0], p[static_cast<std::size_t>(k)][1], 1;
  const Eigen::Vector3d weights = system.colPivHouseholderQr().solve(Eigen::Vector3d(x + 0.5, y + 0.5, 1));
  Eigen::Matrix3d t, b, n;  // of corners
  double sign = 0;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = piece_.mesh.triangles[i][static_cast<std::size_t>(k)];
    n.col(k) = eigen(piece_.mesh.normals[vertex]);
    double w = 0;
    if (options_.basis == MapBasis::stored) {
      t.col(k) = eigen(piece_.mesh.tangents[vertex].xyz());
      w = piece_.mesh.tangents[vertex].w;
    } else {
      const CornerFrame& f = frames_.corner(3 * i + static_cast<std::size_t>(k));
      t.col(k) = eigen(f.t);
      w = piece_.v_up ? f.sign : -f.sign;
    }
    if (k == 0) sign = w;
    b.col(k) = w * n.col(k).normalized().cross(t.col(k));
  }
  Eigen::Matrix3d m;
  if (options_.decode == MapDecode::mikktspace) {
    m.col(0) = t * weights;
    m.col(2) = n * weights;
    m.col(1) = sign * m.col(2).cross(m.col(0));
  } else {
    n.colwise().normalize();
    m << (t * weights).normalized(), (b * weights).normalized(), (n * weights).normalized();
  }
  m.leftCols<2>() *= piece_.scale;
  return m;
}

Returned returned(const Image& map, const NormalMapResult& there, const Image& back,
                  const SecondNormalMap& second) {
  Returned result;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x);
      if (there.states[i] != TexelState::covered) continue;
      double c = 1;
      for (const SecondFrame& f : second.frames(x, y)) c = std::fmax(c, f.condition());
      ++result.texels;
      result.above_10 += c > 10;
      result.orthonormal += c < 1.01;
      // 1e-9: of a condition that is 1 but for rounding.
      const double bound = std::ceil(0.87 * (c - 1e-9) + 0.5) - 1;
      for (std::size_t k = 0; k < 3; ++k)
        result.wrong += c <= 10 && std::fabs(code_at(back, 3 * i + k) - code_at(map, 3 * i + k)) > bound;
    }
  return result;
}

}  // namespace darboux::test
