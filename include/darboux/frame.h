/// \file frame.h
/// Frames from partials, Gram-Schmidt orthonormalisation, rotation between object and tangent space,
/// transformation by affine maps.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include <darboux/surface.h>

namespace darboux {

namespace detail {

[[noreturn]] void throw_singular_transform();

}  // namespace detail

/// The angle between two unit vectors, in radians, 0 to π. Accurate near 0 and near π. NaN if an input is
/// NaN. [Kahan2006]
template <std::floating_point S>
S angle_between_units(const Vec3<S>& p, const Vec3<S>& q) {
  const S chord = norm(p - q), square = chord * chord;
  if (chord < S(1) / 64)  // 2 asin(chord/2), in a third of the time
    return chord * (1 + square * (S(1) / 24 + square * (S(3) / 640 + square * (S(5) / 7168))));
  return S(2) * std::atan2(chord, norm(p + q));
}

/// The same for vectors of any non-zero length. Meaningless if one is zero.
template <std::floating_point S>
S angle_between(const Vec3<S>& a, const Vec3<S>& b) {
  return angle_between_units(unit(a), unit(b));
}

/// The orthonormal frame of two partials: t = dpdu/|dpdu|, n = dpdu × dpdv / |dpdu × dpdv|, b = n × t,
/// handedness = +1. Partials may have any finite length: they are scaled first. If no frame exists, the
/// vectors are NaN and the status is no_frame with dpdu_zero, dpdv_zero, parallel or, for NaN and infinity,
/// non_finite_input. Error: about 2u / sin(angle between the partials), u the unit roundoff. Cost: about 90
/// ns.
template <detail::Binary S>
Frame<S> frame_from_partials(const Vec3<S>& dpdu, const Vec3<S>& dpdv) {
  if constexpr (detail::Lanewise<S>) {
    detail::ordinary_square(dpdv);
    const Vec3<S> t = unit(dpdu), n = unit(accurate_cross(dpdu, dpdv));
    return {t, accurate_cross(n, t), n, S(1), Status::regular};
  } else {
    Frame<S> frame = detail::no_frame<S>();
    if (!detail::finite(dpdu) || !detail::finite(dpdv)) {
      frame.status |= Status::non_finite_input;
      return frame;
    }
    if (dpdu == Vec3<S>{}) frame.status |= Status::dpdu_zero;
    if (dpdv == Vec3<S>{}) frame.status |= Status::dpdv_zero;
    if (has(frame.status, Status::dpdu_zero | Status::dpdv_zero)) return frame;
    const Vec3<S> a = detail::scaled_by_power_of_two(dpdu, -detail::scale_exponent(dpdu));
    const Vec3<S> b = detail::scaled_by_power_of_two(dpdv, -detail::scale_exponent(dpdv));
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
}

/// Gram-Schmidt: makes a tangent and a bitangent of any length orthonormal to a unit normal n, which is kept:
///   t' = unit(t - (t·n) n),   b' = unit(b - (b·n) n - (b·t') t')
/// handedness is the sign of det(t, b, n): -1 if (t', b', n) is left-handed. If t is parallel to n, t' and b'
/// are NaN; if b lies in the plane of t and n, b' is NaN. In both cases the status is no_frame. [Lengyel2001]
template <std::floating_point S>
struct Orthogonalised {
  Vec3<S> t, b, n;
  S handedness;
  Status status = Status::regular;
};
template <std::floating_point S>
Orthogonalised<S> gram_schmidt(const Vec3<S>& t, const Vec3<S>& b, const Vec3<S>& n) {
  // If the unit vector lies in the span of those subtracted, rounding leaves a remainder of up to 16u, which
  // is no direction.
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

/// The matrix (t b n) that maps tangent-space directions, such as those of a normal map, to object space. It
/// is a rotation for an orthonormal frame; for a ParametricFrame on an oblique chart it is not.
template <class AnyFrame>
auto tangent_to_object(const AnyFrame& frame) {
  using S = decltype(frame.t.x + frame.t.x);
  Eigen::Matrix<S, 3, 3> m;
  m << to_eigen(frame.t), to_eigen(frame.b), to_eigen(frame.n);
  return m;
}

/// The rotation that maps object-space directions (to the light, to the eye) to tangent space: the transpose
/// of tangent_to_object(), with rows t, b, n.
template <class S>
Eigen::Matrix<S, 3, 3> object_to_tangent(const Frame<S>& frame) {
  return tangent_to_object(frame).transpose();
}

/// A rotation as a homogeneous 4x4 matrix without translation, for shaders.
template <class S>
Eigen::Matrix<S, 4, 4> homogeneous(const Eigen::Matrix<S, 3, 3>& rotation) {
  Eigen::Matrix<S, 4, 4> m = Eigen::Matrix<S, 4, 4>::Identity();
  m.template topLeftCorner<3, 3>() = rotation;
  return m;
}

/// Conventions for the sign w of a stored tangent. The bitangent is w · cross(n, t).
enum class SignConvention {
  gltf,  ///< w = -handedness for uvs stored as (u, v): glTF's v runs down the image
  raw,   ///< w = +handedness: MikkTSpace's convention
};

/// (t, w) as stored in files and vertex buffers.
template <class S>
Vec4<S> tangent4(const Frame<S>& frame, SignConvention convention = SignConvention::gltf) {
  return {frame.t.x, frame.t.y, frame.t.z,
          convention == SignConvention::raw ? frame.handedness : -frame.handedness};
}

/// Transforms frames by an affine map with linear part M: tangents by M, normals by the inverse transpose of
/// M, handedness by the sign of det M. A mirror (det M < 0) flips the handedness, never n.
template <std::floating_point S>
class FrameTransform {
 public:
  using Matrix = Eigen::Matrix<S, 3, 3>;

  /// \throws ParameterError if M is singular to working precision or not finite
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

  /// Transforms both t and b by M.
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
