#include "rasterise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <darboux/error.h>

#include "base/text.h"
#include "io/write_png.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool given(const Vec3<double>& a) {
  const double square = dot(a, a);
  return square > 0 && square < infinity;  // false for NaN
}

int sign(double x) {
  return (x > 0) - (x < 0);
}

// ---- signs without rounding -----------------------------------------------------------------------------

// A sum of doubles, kept exactly: parts that do not overlap, the smallest first [Shewchuk1997, sec. 2.4].
class ExactSum {
 public:
  void add(double x) {
    for (std::size_t i = 0; i < count_; ++i) {
      const double sum = parts_[i] + x, of_x = sum - parts_[i];
      parts_[i] = (parts_[i] - (sum - of_x)) + (x - of_x);
      x = sum;
    }
    parts_[count_++] = x;
  }
  void add_product(double a, double b) {
    const auto p = detail::exact_product(a, b);
    add(p.high);
    add(p.low);
  }
  void add_product(double a, double b, double c) {
    const auto p = detail::exact_product(a, b);
    add_product(p.high, c);
    add_product(p.low, c);
  }
  int sign() const {
    for (std::size_t i = count_; i > 0; --i)
      if (parts_[i - 1] != 0) return parts_[i - 1] > 0 ? 1 : -1;
    return 0;
  }

 private:
  std::array<double, 24> parts_;
  std::size_t count_ = 0;
};

// a × b of points in pixels times w: its product with (x, y, 1) is zero on the line through a and b. b × a
// is its exact negative.
struct Edge {
  Edge(const Vec3<double>& from, const Vec3<double>& to, double width, double height)
      : a(from), b(to), x(a.y * b.z - a.z * b.y), y(a.z * b.x - a.x * b.z), z(a.x * b.y - a.y * b.x) {
    // Three roundings per product, two per sum, doubled for safety.
    constexpr double roundings = 10 * 0x1p-53;
    doubt = roundings * (width * (std::fabs(a.y * b.z) + std::fabs(a.z * b.y)) +
                         height * (std::fabs(a.z * b.x) + std::fabs(a.x * b.z)) + std::fabs(a.x * b.y) +
                         std::fabs(a.y * b.x));
    on_it = sign(difference_of_products(a.y, b.z, a.z, b.y));
    if (on_it == 0) on_it = sign(difference_of_products(a.z, b.x, a.x, b.z));
  }

  double at(double px, double py) const { return px * x + py * y + z; }

  // The side of the line on which a point is. A point on it counts as slightly to the right, and far less
  // below: never 0, except for an edge without length.
  int side(double px, double py, double value) const {
    if (std::fabs(value) > doubt) return sign(value);
    ExactSum sum;
    sum.add_product(a.y, b.z, px);
    sum.add_product(-a.z, b.y, px);
    sum.add_product(a.z, b.x, py);
    sum.add_product(-a.x, b.z, py);
    sum.add_product(a.x, b.y);
    sum.add_product(-a.y, b.x);
    const int exact = sum.sign();
    return exact != 0 ? exact : on_it;
  }

  Vec3<double> a, b;
  double x, y, z;
  double doubt;  // values up to it may have the wrong sign, anywhere in the picture
  int on_it;
};

// The pixels whose centres may lie between two coordinates.
std::pair<int, int> pixels(double least, double most, int size) {
  const auto clamped = [&](double x) { return static_cast<int>(std::clamp(x, 0.0, double(size))); };
  // One pixel more than rounding requires.
  return {clamped(least - 1 - 1e-9 * std::fabs(least)), clamped(most + 2 + 1e-9 * std::fabs(most))};
}

// A smooth odd wave of period 1 between about ±1.
double wave(double x) {
  const double f = x - std::floor(x);
  return 10.392304845413264 * (f * (1 - f) * (1 - 2 * f));  // 6 √3
}

std::uint8_t encoded(double linear) {
  // A gamma of 2, close to sRGB's and the same on every machine.
  return static_cast<std::uint8_t>(std::floor(255 * std::sqrt(std::clamp(linear, 0.0, 1.0)) + 0.5));
}

}  // namespace

Vec3<double> bump(const Vec2<double>& uv) {
  constexpr double count = 16, slope = 0.4;
  return unit(Vec3<double>{slope * wave(count * uv.x), -slope * wave(count * uv.y), 1});
}

Rasteriser::Rasteriser(const Camera& camera)
    : perspective_(camera.projection == Camera::Projection::perspective),
      near_(camera.near_distance),
      far_(camera.far_distance) {
  camera.check();
  constexpr double most = 1 << 26;
  if (double(camera.width_px) * double(camera.height_px) > most)
    throw ParameterError(
        "picture", expected_got("at most 2^26 pixels",
                                std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px)));
  scale_ = perspective_ ? camera.height_px / 2.0 / std::tan(camera.vertical_field_of_view_rad / 2)
                        : camera.height_px / camera.view_height;
  eye_ = from_eigen(camera.pose.translation());
  right_ = from_eigen(camera.pose.linear().col(0));
  up_ = from_eigen(camera.pose.linear().col(1));
  back_ = from_eigen(camera.pose.linear().col(2));
  to_light_ = unit(-1.0 * right_ + 2.0 * up_ + 3.0 * back_);  // over the left shoulder
  picture_ = {camera.width_px, camera.height_px, {}};
  const std::size_t count = index(0, camera.height_px);
  picture_.rgb.assign(3 * count, 255);
  depth_.assign(count, infinity);
  order_.assign(count, 0);
}

Rasteriser::Corner Rasteriser::corner(const PictureVertex& v) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Corner c{};
  const Vec3<double> from_eye = v.position - eye_;
  const double x = dot(right_, from_eye), y = dot(up_, from_eye);
  c.depth = -dot(back_, from_eye);
  const double w = perspective_ ? c.depth : 1;
  c.at = {0.5 * picture_.width * w + scale_ * x, 0.5 * picture_.height * w - scale_ * y, w};
  c.position = v.position;
  c.uv = v.uv;
  const bool has_normal = given(v.normal);
  c.n = has_normal ? v.normal : Vec3<double>{};
  c.facing = has_normal ? dot(v.normal, perspective_ ? -from_eye : back_) : nan;
  if (has_normal && given(v.tangent.xyz())) {
    c.t = v.tangent.xyz();
    c.b = v.tangent.w * cross(c.n, c.t);
  }
  return c;
}

void Rasteriser::add(std::span<const PictureVertex> vertices, std::span<const std::uint32_t> indices,
                     const PictureMaterial& material, std::uint64_t order) {
  corners_.clear();
  for (const PictureVertex& v : vertices) corners_.push_back(corner(v));
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    draw(corners_[indices[i]], corners_[indices[i + 1]], corners_[indices[i + 2]], material, order);
}

void Rasteriser::draw(const Corner& a, const Corner& b, const Corner& c, const PictureMaterial& material,
                      std::uint64_t order) {
  const Corner* const corners[3] = {&a, &b, &c};
  double left = infinity, right = -infinity, top = infinity, bottom = -infinity;
  const auto reach = [&](double x, double y) {
    left = std::fmin(left, x);
    right = std::fmax(right, x);
    top = std::fmin(top, y);
    bottom = std::fmax(bottom, y);
  };
  // The box of the part beyond the near plane.
  double facing[3], nearest = infinity, farthest = -infinity, sum_of_facing = 0;
  int with_facing = 0;
  for (int i = 0; i < 3; ++i) {
    const Corner &p = *corners[i], &q = *corners[(i + 1) % 3];
    if (!std::isfinite(p.at.x) || !std::isfinite(p.at.y) || !std::isfinite(p.depth)) return;
    nearest = std::fmin(nearest, p.depth);
    farthest = std::fmax(farthest, p.depth);
    if (p.depth >= near_) reach(p.at.x / p.at.z, p.at.y / p.at.z);
    if ((p.depth < near_) != (q.depth < near_)) {
      const double s = (near_ - p.depth) / (q.depth - p.depth), w = perspective_ ? near_ : 1;
      reach((p.at.x + s * (q.at.x - p.at.x)) / w, (p.at.y + s * (q.at.y - p.at.y)) / w);
    }
    facing[i] = p.facing;
    if (std::isnan(p.facing)) continue;
    sum_of_facing += p.facing;
    ++with_facing;
  }
  if (farthest < near_ || nearest > far_) return;
  const Vec3<double> face = cross(b.position - a.position, c.position - a.position);
  for (double& f : facing)
    if (std::isnan(f))
      f = with_facing > 0 ? sum_of_facing / with_facing : dot(face, perspective_ ? eye_ - a.position : back_);
  if (!material.double_sided && !(std::fmax(facing[0], std::fmax(facing[1], facing[2])) > 0)) return;

  const auto [x0, x1] = pixels(left, right, picture_.width);
  const auto [y0, y1] = pixels(top, bottom, picture_.height);
  if (x0 >= x1 || y0 >= y1) return;
  const double width = picture_.width, height = picture_.height;
  // Edge i is opposite to corner i.
  const Edge edges[3] = {
      {b.at, c.at, width, height}, {c.at, a.at, width, height}, {a.at, b.at, width, height}};
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double e[3] = {edges[0].at(px, py), edges[1].at(px, py), edges[2].at(px, py)};
      const int side = edges[0].side(px, py, e[0]);
      if (side == 0 || edges[1].side(px, py, e[1]) != side || edges[2].side(px, py, e[2]) != side) continue;
      // In triangles far smaller than a pixel the weights may be mere rounding: they are clamped to the
      // triangle.
      double weights[3] = {std::fmax(0, side * e[0]), std::fmax(0, side * e[1]), std::fmax(0, side * e[2])};
      const double sum = weights[0] + weights[1] + weights[2];
      for (double& weight : weights) weight = sum > 0 ? weight / sum : 1.0 / 3;
      const double depth = weights[0] * a.depth + weights[1] * b.depth + weights[2] * c.depth;
      const double f = weights[0] * facing[0] + weights[1] * facing[1] + weights[2] * facing[2];
      const std::size_t i = index(x, y);
      // Points behind the eye have negative depth here.
      const bool nearer = depth < depth_[i] || (depth == depth_[i] && order < order_[i]);
      if (!(depth >= near_ && depth <= far_ && nearer) || (!material.double_sided && !(f > 0))) continue;
      depth_[i] = depth;
      order_[i] = order;
      const Vec3<double> colour = shade(corners, weights, f < 0, material);
      picture_.rgb[3 * i] = encoded(colour.x);
      picture_.rgb[3 * i + 1] = encoded(colour.y);
      picture_.rgb[3 * i + 2] = encoded(colour.z);
    }
}

Vec3<double> Rasteriser::shade(const Corner* const (&corners)[3], const double (&weights)[3],
                               bool from_behind, const PictureMaterial& material) const {
  Vec3<double> n, t, b;
  Vec2<double> uv;
  for (int i = 0; i < 3; ++i) {
    n += weights[i] * corners[i]->n;
    t += weights[i] * corners[i]->t;
    b += weights[i] * corners[i]->b;
    uv = uv + weights[i] * corners[i]->uv;
  }
  if (!given(n))
    n = cross(corners[1]->position - corners[0]->position, corners[2]->position - corners[0]->position);
  n = unit(n);
  if (material.normal_map && material.object_space) {
    n = unit(material.normal_map(uv));
  } else if (material.normal_map && given(t) && given(b)) {
    const Vec3<double> texel = material.normal_map(uv);
    n = unit(texel.x * unit(t) + texel.y * unit(b) + texel.z * n);
  }
  const double light = std::fmax(0, from_behind ? -dot(n, to_light_) : dot(n, to_light_));
  constexpr double ambient = 0.12;
  return (ambient + (1 - ambient) * light) * material.colour;
}

std::string png_of(const Picture& picture) {
  return io::png_of(picture.width, picture.height, picture.rgb);
}

}  // namespace darboux
