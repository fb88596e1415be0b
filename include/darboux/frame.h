/// \file frame.h
/// Frames from partials, Gram-Schmidt, rotation between object and tangent space, transformation by affine
/// maps.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include <darboux/surface.h>

namespace darboux {

namespace detail {

[[noreturn]] void throw_singular_transform();

template <std::floating_point S>
S largest_component(const Vec3<S>& a) {
  return std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z)));
}

// The greatest power of two not above the largest component, as an exponent; 0 for a zero or non-finite vector.
template <std::floating_point S>
int exponent(const Vec3<S>& a) {
  const S m = largest_component(a);
  return m > 0 && std::isfinite(m) ? std::ilogb(m) : 0;
}

// The same, but 0 where the squares of the components that matter are ordinary numbers: nothing to scale.
template <std::floating_point S>
int scale_exponent(const Vec3<S>& a) {
  constexpr S small = std::same_as<S, float> ? S(0x1p-38) : S(0x1p-450), large = 1 / small;
  const S m = largest_component(a);
  return small < m && m < large ? 0 : exponent(a);
}

template <std::floating_point S>
Vec3<S> scaled_by_power_of_two(const Vec3<S>& a, int exponent) {
  return {std::scalbn(a.x, exponent), std::scalbn(a.y, exponent), std::scalbn(a.z, exponent)};
}

// a b and its rounding error, by splitting (Dekker 1971). [Dekker1971]
template <std::floating_point S>
struct Product {
  S value, error;
  Product(S a, S b) : value(a * b) {
    constexpr S splitter = S((std::uint64_t{1} << ((std::numeric_limits<S>::digits + 1) / 2)) + 1);
    const S ca = splitter * a, cb = splitter * b;
    const S ah = ca - (ca - a), al = a - ah, bh = cb - (cb - b), bl = b - bh;
    error = ((ah * bh - value) + ah * bl + al * bh) + al * bl;
  }
};

}  // namespace detail

/// a b - c d with an error of at most 2 ulp of the result, whatever cancels: both products are taken exactly.
/// For |a|, |b|, |c|, |d| whose products neither overflow nor underflow. [Jeannerod2013] has the fma form.
template <std::floating_point S>
S difference_of_products(S a, S b, S c, S d) {
  const detail::Product<S> ab(a, b), cd(c, d);
  return (ab.value - cd.value) + (ab.error - cd.error);
}

/// The length of a, without overflow or underflow in between.
template <std::floating_point S>
S norm(const Vec3<S>& a) {
  const int e = detail::scale_exponent(a);
  if (e == 0) return std::sqrt(dot(a, a));
  const Vec3<S> scaled = detail::scaled_by_power_of_two(a, -e);
  return std::scalbn(std::sqrt(dot(scaled, scaled)), e);
}

/// a / |a|, each component within 2 ulp; the zero vector for a zero one.
template <std::floating_point S>
Vec3<S> unit(const Vec3<S>& a) {
  const int e = detail::scale_exponent(a);
  const Vec3<S> scaled = e == 0 ? a : detail::scaled_by_power_of_two(a, -e);
  const S length = std::sqrt(dot(scaled, scaled));
  return length == S(0) ? scaled : scaled / length;
}

/// a × b for vectors of ordinary size (scale first), each component a difference of products.
template <std::floating_point S>
Vec3<S> accurate_cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

/// The angle between two directions of any length, in radians, accurate near 0 and near π. [Kahan2006]
template <std::floating_point S>
S angle_between(const Vec3<S>& a, const Vec3<S>& b) {
  const Vec3<S> p = unit(a), q = unit(b);
  return S(2) * std::atan2(norm(p - q), norm(p + q));
}

/// The orthonormal frame of two partials: t = dpdu/|dpdu|, n = dpdu × dpdv / |dpdu × dpdv|, b = n × t. Both
/// are scaled to ordinary size first, so any representable lengths do. Where it does not exist the vectors
/// are NaN and the status says why: dpdu_zero, dpdv_zero or parallel, with no_frame; non_finite_input for NaN
/// or infinity. Error about 2u / sin(angle between the partials) with u the unit roundoff. About 90 ns.
template <std::floating_point S>
Frame<S> frame_from_partials(const Vec3<S>& dpdu, const Vec3<S>& dpdv) {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  Frame<S> frame{{nan, nan, nan}, {nan, nan, nan}, {nan, nan, nan}, S(1), Status::no_frame};
  if (!detail::finite(dpdu) || !detail::finite(dpdv)) {
    frame.status |= Status::non_finite_input;
    return frame;
  }
  if (dpdu == Vec3<S>{}) frame.status |= Status::dpdu_zero;
  if (dpdv == Vec3<S>{}) frame.status |= Status::dpdv_zero;
  if (has(frame.status, Status::dpdu_zero | Status::dpdv_zero)) return frame;
  const Vec3<S> a = detail::scaled_by_power_of_two(dpdu, -detail::exponent(dpdu));
  const Vec3<S> b = detail::scaled_by_power_of_two(dpdv, -detail::exponent(dpdv));
  const Vec3<S> normal = accurate_cross(a, b);
  if (normal == Vec3<S>{}) {
    frame.status |= Status::parallel;
    return frame;
  }
  frame.t = unit(a);
  frame.n = unit(normal);
  frame.b = accurate_cross(frame.n, frame.t);
  frame.status = Status::regular;
  return frame;
}

/// Orthonormal frame from a tangent, bitangent and unit normal that are nearly one:
///   t' = unit(t - (t·n) n),   b' = unit(b - (b·n) n - (b·t') t')
/// n is kept. The handedness is the sign of det(t, b, n); b' keeps b's side, so (t', b', n) is left-handed
/// where it is negative. NaN with no_frame where t is parallel to n, or b lies in the plane of t and n.
/// [Lengyel2001]
template <std::floating_point S>
struct Orthogonalised {
  Vec3<S> t, b, n;
  S handedness;
  Status status = Status::regular;
};
template <std::floating_point S>
Orthogonalised<S> gram_schmidt(const Vec3<S>& t, const Vec3<S>& b, const Vec3<S>& n) {
  // Of a unit vector in the span of those taken off, rounding leaves up to 16u: that is no direction.
  const auto direction = [](const Vec3<S>& rest) {
    return norm(rest) > S(8) * std::numeric_limits<S>::epsilon() ? unit(rest) : Vec3<S>{};
  };
  const Vec3<S> t0 = unit(t), b0 = unit(b);
  const Vec3<S> t1 = direction(t0 - dot(t0, n) * n);
  const Vec3<S> b1 = direction(b0 - dot(b0, n) * n - dot(b0, t1) * t1);
  Orthogonalised<S> result{t1, b1, n, dot(cross(t1, b1), n) < S(0) ? S(-1) : S(1)};
  if (t1 == Vec3<S>{} || b1 == Vec3<S>{}) {
    constexpr S nan = std::numeric_limits<S>::quiet_NaN();
    if (t1 == Vec3<S>{}) result.t = {nan, nan, nan};
    result.b = {nan, nan, nan};
    result.status = Status::no_frame;
  }
  return result;
}

/// The rotation that takes tangent-space directions (a normal map's) to object space: columns t, b, n.
/// For a ParametricFrame the columns are the coordinate directions: not a rotation on an oblique chart.
template <class AnyFrame>
auto tangent_to_object(const AnyFrame& frame) {
  using S = decltype(frame.t.x + frame.t.x);
  Eigen::Matrix<S, 3, 3> m;
  m << to_eigen(frame.t), to_eigen(frame.b), to_eigen(frame.n);
  return m;
}

/// The rotation that takes object-space directions (to the light, to the eye) into tangent space: the
/// transpose of tangent_to_object, rows t, b, n.
template <class S>
Eigen::Matrix<S, 3, 3> object_to_tangent(const Frame<S>& frame) {
  return tangent_to_object(frame).transpose();
}

/// A rotation as a 4x4 matrix without translation, as shaders take it.
template <class S>
Eigen::Matrix<S, 4, 4> homogeneous(const Eigen::Matrix<S, 3, 3>& rotation) {
  Eigen::Matrix<S, 4, 4> m = Eigen::Matrix<S, 4, 4>::Identity();
  m.template topLeftCorner<3, 3>() = rotation;
  return m;
}

/// The conventions in which files store the sign w of a tangent; the bitangent is w · cross(n, t).
enum class SignConvention {
  gltf,  ///< w = -handedness for uvs stored as (u, v): glTF's v runs down the image
  raw,   ///< w = +handedness: MikkTSpace's own
};

/// (t, w) as stored in files and vertex buffers.
template <class S>
Vec4<S> tangent4(const Frame<S>& frame, SignConvention convention = SignConvention::gltf) {
  return {frame.t.x, frame.t.y, frame.t.z,
          convention == SignConvention::raw ? frame.handedness : -frame.handedness};
}

/// An affine map prepared for frames: tangents go by M, normals by the inverse transpose, the handedness by
/// the sign of det M (a mirror flips it; n itself is never flipped silently).
template <std::floating_point S>
class FrameTransform {
 public:
  using Matrix = Eigen::Matrix<S, 3, 3>;

  /// \throws ParameterError when M is singular to working precision or not finite
  explicit FrameTransform(const Matrix& m) {
    const S largest = m.cwiseAbs().maxCoeff();
    const int e = largest > 0 && std::isfinite(largest) ? std::ilogb(largest) : 0;
    m_ = m.unaryExpr([e](S x) { return std::scalbn(x, -e); });
    const Eigen::JacobiSVD<Matrix> svd(m_);
    if (!m.allFinite() ||
        !(svd.singularValues()[2] > 4 * std::numeric_limits<S>::epsilon() * svd.singularValues()[0]))
      detail::throw_singular_transform();
    inverse_transpose_ = m_.inverse().transpose();
    sign_ = m_.determinant() < S(0) ? S(-1) : S(1);
  }
  explicit FrameTransform(const Eigen::Transform<S, 3, Eigen::Affine>& map)
      : FrameTransform(Matrix(map.linear())) {}

  Frame<S> operator()(const Frame<S>& frame) const {
    Frame<S> result = frame;
    result.t = unit(from_eigen(m_ * to_eigen(frame.t)));
    result.n = unit(from_eigen(inverse_transpose_ * to_eigen(frame.n)));
    result.b = accurate_cross(result.n, result.t);
    result.handedness = sign_ * frame.handedness;
    return result;
  }

  /// Coordinate directions go by M, both of them.
  ParametricFrame<S> operator()(const ParametricFrame<S>& frame) const {
    ParametricFrame<S> result = frame;
    result.t = unit(from_eigen(m_ * to_eigen(frame.t)));
    result.b = unit(from_eigen(m_ * to_eigen(frame.b)));
    result.n = unit(from_eigen(inverse_transpose_ * to_eigen(frame.n)));
    result.handedness = sign_ * frame.handedness;
    return result;
  }

 private:
  Matrix m_, inverse_transpose_;
  S sign_;
};

}  // namespace darboux
