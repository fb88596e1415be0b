#include "starts.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "base/quantile.h"

namespace darboux {
namespace {

// x^T = O^T + sum_k B_k(u, v)^T A_k^T over the lengths k, B_k = ∂P/∂p_k: linear in O and the A_k, rows of
// `solution`.
struct Linear {
  std::vector<int> lengths;
  Eigen::MatrixXd design, targets;
  Eigen::MatrixXd solution;
  std::vector<double> distances;
  // Buffers of set_up(), kept for the next call.
  std::vector<Vec2<double>> uvs;
  UvBlock block;
};

// Makes `linear` that problem.
void set_up(Linear& linear, const UvModel& model, const Affine& affine, const std::vector<double>& at) {
  const UvKind& kind = *model.kind;
  const std::size_t n = model.points->count();
  linear.lengths.clear();
  for (int k = 0; k < kind.parameter_count(); ++k)
    if (kind.length[static_cast<std::size_t>(k)] && kind.tied_to[static_cast<std::size_t>(k)] == k)
      linear.lengths.push_back(k);
  const UvConvention map{"", affine};
  std::vector<Vec2<double>>& uvs = linear.uvs;
  uvs.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    uvs[i] = map.surface_uv(model.convention.surface_uv(model.points->uvs[i]));
  const auto rows = static_cast<Eigen::Index>(n);
  UvBlock& block = linear.block;
  block.position.resize(3 * rows);
  block.by_parameter.resize(3 * rows, kind.parameter_count());
  kind.evaluate(at.data(), uvs, block);
  for (int k = 0; k < kind.parameter_count(); ++k)
    if (const int with = kind.tied_to[static_cast<std::size_t>(k)]; with != k)
      block.by_parameter.col(with) +=
          at[static_cast<std::size_t>(k)] / at[static_cast<std::size_t>(with)] * block.by_parameter.col(k);
  linear.design.resize(rows, 1 + 3 * static_cast<Eigen::Index>(linear.lengths.size()));
  linear.design.col(0).setOnes();
  for (std::size_t k = 0; k < linear.lengths.size(); ++k)
    linear.design.middleCols<3>(1 + 3 * static_cast<Eigen::Index>(k)) =
        block.by_parameter.col(linear.lengths[k]).reshaped(3, rows).transpose();
  linear.targets = model.points->cloud.transpose();
}
Linear linear_problem(const UvModel& model, const Affine& affine, const std::vector<double>& at) {
  Linear linear;
  set_up(linear, model, affine, at);
  return linear;
}

// Least squares, then least distances by reweighting. The solution has minimum norm if the data do not
// determine a direction: A_k is zero there. False if the uvs make the surface so large that squares leave the
// range of numbers.
bool solve(Linear& linear, int rounds) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(linear.design.rows());
  linear.distances.resize(static_cast<std::size_t>(linear.design.rows()));
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd weighted = weights.asDiagonal() * linear.design;
    const Eigen::MatrixXd normal = weighted.transpose() * linear.design;
    if (!normal.allFinite()) return false;
    const auto [values, vectors] = symmetric_eigen(normal);
    const double largest = values.maxCoeff();
    const Eigen::VectorXd inverse =
        values.unaryExpr([&](double d) { return d > 1e-12 * largest ? 1 / d : 0.0; });
    linear.solution = vectors * inverse.asDiagonal() *
                      (vectors.transpose() * (weighted.transpose() * linear.targets)).eval();
    const Eigen::VectorXd distances = (linear.design * linear.solution - linear.targets).rowwise().norm();
    Eigen::VectorXd::Map(linear.distances.data(), distances.size()) = distances;
    if (round + 1 < rounds) {
      const double floor = 1e-3 * median(linear.distances) + 1e-12;
      weights = distances.unaryExpr([&](double d) { return 1 / std::fmax(d, floor); });
    }
  }
  return linear.solution.allFinite();
}

// The rms distance that least squares would leave, without a solution: the part of the targets that is
// orthogonal to all columns of the design. Infinite if solve() would return false. Overwrites the problem.
double residual(Linear& linear) {
  Eigen::MatrixXd& a = linear.design;
  const double least = 1e-6 * std::sqrt(a.colwise().squaredNorm().maxCoeff());
  if (!std::isfinite(least)) return std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < a.cols(); ++k) {
    auto column = a.col(k);
    const double length = column.norm();
    if (!(length > least)) continue;
    column /= length;
    for (Eigen::Index j = k + 1; j < a.cols(); ++j) a.col(j) -= column.dot(a.col(j)) * column;
    for (Eigen::Index j = 0; j < 3; ++j) linear.targets.col(j) -= column.dot(linear.targets.col(j)) * column;
  }
  return std::sqrt(linear.targets.squaredNorm() / static_cast<double>(a.rows()));
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& a) {
  auto [u, values, v] = singular_value_decomposition(a);
  if ((u * v.transpose()).determinant() < 0) u.col(2) *= -1;
  return u * v.transpose();
}

// Rotation and lengths with A_k = p_k Q on the span of the B_k; lengths that may be negative take both signs.
UvState rigid(const UvModel& model, const Linear& linear, const Affine& affine, const std::vector<double>& at,
              const UvHeld& held, bool mirrored) {
  const UvKind& kind = *model.kind;
  const double sign = mirrored ? -1 : 1;
  std::vector<Eigen::Matrix3d> a;
  std::vector<Eigen::Vector3d> span;
  for (std::size_t k = 0; k < linear.lengths.size(); ++k) {
    const auto row = 1 + 3 * static_cast<Eigen::Index>(k);
    Eigen::Vector3d present;
    for (int axis = 0; axis < 3; ++axis)
      present[axis] = linear.design.col(row + axis).cwiseAbs().maxCoeff() > 1e-9;
    span.push_back(present);
    a.push_back(sign * linear.solution.middleRows<3>(row).transpose() * present.asDiagonal());
  }
  const std::size_t count = a.size();
  UvState best;
  best.parameters = at;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned signs = 0; signs < (1u << count); ++signs) {
    std::vector<double> lengths(count);
    bool permitted = true;
    for (std::size_t k = 0; k < count; ++k) {
      const Range& range = kind.parameters[static_cast<std::size_t>(linear.lengths[k])].permitted;
      const bool negative = (signs >> k & 1u) != 0;
      permitted = permitted && (!negative || range.minimum < 0);
      lengths[k] = (negative ? -1 : 1) * a[k].norm() / std::sqrt(std::fmax(span[k].sum(), 1));
    }
    if (!permitted) continue;
    Eigen::Matrix3d rotation;
    double error = 0;
    for (int round = 0; round < 3; ++round) {
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (std::size_t k = 0; k < count; ++k) sum += lengths[k] * a[k];
      rotation = nearest_rotation(sum);
      error = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const Range& range = kind.parameters[static_cast<std::size_t>(linear.lengths[k])].permitted;
        if (span[k].sum() > 0)
          lengths[k] = std::fmax((rotation.transpose() * a[k]).trace() / span[k].sum(),
                                 range.minimum_included ? range.minimum : range.minimum + 1e-3);
        error += (a[k] - lengths[k] * (rotation * span[k].asDiagonal())).squaredNorm();
      }
    }
    if (!(error < least)) continue;
    least = error;
    best.rotation = Eigen::Quaterniond(rotation).normalized();
    for (std::size_t k = 0; k < count; ++k)
      best.parameters[static_cast<std::size_t>(linear.lengths[k])] = lengths[k];
  }
  for (std::size_t k = 0; k < at.size(); ++k)
    if (const auto with = static_cast<std::size_t>(kind.tied_to[k]); with != k)
      best.parameters[k] = best.parameters[with] * at[k] / at[with];
  best.translation = sign * linear.solution.row(0).transpose();
  best.affine = affine;
  for (std::size_t k = 0; k < held.parameters.size(); ++k)
    if (held.parameters[k]) best.parameters[k] = *held.parameters[k];
  if (held.placement) {
    best.rotation = Eigen::Quaterniond(held.placement->linear());
    best.translation = held.placement->translation();
  }
  return best;
}

double median_distance(const UvModel& model, const UvState& state) {
  return std::sqrt(median(model.squares(state)));
}

UvModel model_of(const UvKind& kind, const fit::NormalisedPoints& points, const UvConvention& convention,
                 const UvHeld& held) {
  UvModel model(kind, points, convention);
  for (std::size_t k = 0; k < held.parameters.size(); ++k) model.held[k] = held.parameters[k].has_value();
  model.placement_held = held.placement.has_value();
  return model;
}

// The image of the points under x -> -x.
fit::NormalisedPoints negated(fit::NormalisedPoints points) {
  points.cloud = -points.cloud;
  return points;
}

constexpr int many_rounds = 8, few_rounds = 4;

// Stored coordinates from `from` on, in units of 1 / scale.
struct Unit {
  double scale = 1, from = 0;
};

// Two units: as stored, counted from the tile of the points; and from 0 to 1 over all points. For coordinates
// in entirely different units, such as pixels, only the latter. For periodic coordinates the latter only if
// the scales that are tried amount to less than three quarters of a turn.
std::vector<Unit> units(Coordinate coordinate, const std::vector<double>& stored) {
  const auto [low, high] = std::minmax_element(stored.begin(), stored.end());
  const double range = *high - *low;
  const bool turns = coordinate == Coordinate::turn;
  const Unit whole{1 / range, *low}, as_stored{1, turns || range > 1 ? 0 : std::floor(median(stored))};
  if (range > 4) return {whole};
  const bool differs = std::fabs(*low) > 1e-3 || std::fabs(*high - 1) > 1e-3;
  if (!(range > 1e-6 && range <= (turns ? 0.25 : 4)) || !differs) return {as_stored};
  return {as_stored, whole};
}

// The convention, counted from the tile of the points. One half-turn further, the chart passes through the
// poles to the same points, but backwards, so no convention maps to itself there.
UvConvention in_its_tile(UvConvention convention, const UvKind& kind, const fit::NormalisedPoints& points) {
  if (kind.coordinates[1] != Coordinate::half_turn) return convention;
  std::vector<double> v;
  for (const Vec2<double>& stored : points.uvs) v.push_back(convention.surface_uv(stored).y);
  convention.affine[5] -= std::floor(median(v));
  return convention;
}

}  // namespace

ConventionStarts convention_starts(const UvKind& kind, const fit::NormalisedPoints& points,
                                   const UvHeld& held, bool robust) {
  const fit::NormalisedPoints image = robust ? negated(points) : fit::NormalisedPoints{};
  ConventionStarts result;
  for (const UvConvention& convention : uv_conventions()) {
    const UvModel model = model_of(kind, points, in_its_tile(convention, kind, points), held);
    std::optional<UvStart> proper, mirrored;
    double least_rms = 0;
    const auto keep_nearer = [&](std::optional<UvStart>& best, UvModel judged, const UvState& state) {
      const double median = median_distance(judged, state);
      if (std::isfinite(median) && (!best || median < best->median))
        best = UvStart{judged, state, median, least_rms};
    };
    for (const auto& at : kind.starts) {
      Linear linear = linear_problem(model, identity_map, at);
      if (!solve(linear, robust ? many_rounds : 1)) continue;
      // The linear problem is less constrained than the rigid one, if only lengths are unknown.
      if (!robust && kind.linear())
        least_rms =
            std::sqrt(Eigen::VectorXd::Map(linear.distances.data(), linear.design.rows()).squaredNorm() /
                      static_cast<double>(linear.design.rows()));
      keep_nearer(proper, model, rigid(model, linear, identity_map, at, held, false));
      if (!robust) continue;
      UvModel reflected = model;
      reflected.points = &image;
      keep_nearer(mirrored, reflected, rigid(model, linear, identity_map, at, held, true));
      if (mirrored) mirrored->model.points = &points;
    }
    if (proper) result.proper.push_back(*proper);
    if (mirrored) result.mirrored.push_back(*mirrored);
  }
  return result;
}

std::vector<int> observable_affine(UvModel model) {
  const fit::NormalisedPoints few = model.points->chosen(64, 1);
  model.points = &few;
  // The offset comes first, as placements absorb it; then scales, which lengths absorb; shears last. If no
  // length is free, a rotation may absorb a shear, as on a plane.
  bool any_length = false;
  for (std::size_t k = 0; k < model.held.size(); ++k)
    any_length = any_length || (model.kind->length[k] && !model.held[k]);
  const std::array<int, 6> order = any_length ? std::array{4, 5, 3, 0, 2, 1} : std::array{4, 5, 2, 1, 3, 0};
  model.free_affine.assign(order.begin(), order.end());
  // Any states without accidental symmetry will do. An offset that a scale and lengths absorb together is
  // held at zero only if they absorb it there too. They do not if a surface depends on v or 2v - 1 and their
  // squares, whose apex is where these vanish.
  std::vector<Eigen::MatrixXd> jacobians;
  for (const double offset : {0.0, 0.5}) {
    UvState state;
    state.parameters = model.kind->starts.front();
    for (std::size_t k = 0; k < state.parameters.size(); ++k)
      state.parameters[k] *= 1 + 0.21 * static_cast<double>(k);
    state.affine = {1.1, 0.07, 0.05, 0.93, offset, offset};
    Eigen::MatrixXd& j = jacobians.emplace_back(model.jacobian(state, few.count()));
    if (model.placement_held) j.leftCols<6>().setZero();
    for (Eigen::Index k = 0; k < j.cols(); ++k)
      if (const double size = j.col(k).norm(); size > 0) j.col(k) /= size;
  }
  const Eigen::Index first = jacobians.front().cols() - 6;
  std::vector<int> observable;
  for (Eigen::Index k = first; k < first + 6; ++k) {
    const auto others_absorb = [k](Eigen::MatrixXd j) {
      const Eigen::VectorXd column = j.col(k);
      j.col(k).setZero();
      return (j * solve_least_norm(j, column, 1e-10) - column).norm() < 1e-8;
    };
    if (!std::all_of(jacobians.begin(), jacobians.end(), others_absorb))
      observable.push_back(order[static_cast<std::size_t>(k - first)]);
    else
      for (Eigen::MatrixXd& j : jacobians) j.col(k).setZero();
  }
  std::sort(observable.begin(), observable.end());
  return observable;
}

namespace {

// The search over affine maps after a convention: a quick test of many, then least squares for the nearest.
class AffineSearch {
 public:
  AffineSearch(const UvKind& kind, const fit::NormalisedPoints& all, const UvHeld& held, bool robust)
      : kind_(kind),
        all_(all),
        held_(held),
        robust_(robust),
        points_(all.chosen(64, 1)),
        few_(points_.chosen(16, 1)),
        model_(model_of(kind, points_, uv_conventions().front(), held)),
        free_(observable_affine(model_)) {}

  std::vector<UvStart> starts(std::span<const double> sheared) {
    constexpr std::size_t looked_at = 160, kept = 40, best = 10;
    if (!robust_) model_.points = &few_;  // without outliers, a few points tell most
    for (const UvConvention& convention : uv_conventions()) look_under(convention, sheared);
    if (!robust_) {
      keep_nearest(looked_at);
      model_.points = &points_;
      for (Candidate& c : candidates_) {
        model_.convention = c.convention;
        c.distance = distance(c);
      }
    }
    keep_nearest(kept);
    std::vector<UvStart> result;
    for (const Candidate& c : candidates_)
      for (const double turn : choices(4, {0, 0.125, 0.25, 0.375}))
        if (std::optional<UvStart> start = start_of(c, turn)) result.push_back(std::move(*start));
    std::stable_sort(result.begin(), result.end(),
                     [](const UvStart& a, const UvStart& b) { return a.median < b.median; });
    if (result.size() > best) result.erase(result.begin() + best, result.end());
    return result;
  }

 private:
  struct Candidate {
    UvConvention convention;
    Affine affine;
    const std::vector<double>* at;
    double distance, outside;  // outside: of the surface's domain
  };

  bool is_free(int k) const { return std::find(free_.begin(), free_.end(), k) != free_.end(); }
  // The values of an entry of the map to try; only that of the identity if it is not free.
  std::vector<double> choices(int k, std::vector<double> values) const {
    return is_free(k) ? values : std::vector{identity_map[static_cast<std::size_t>(k)]};
  }

  // The median residual of the model's points after least squares; infinite if there is no solution.
  double distance(const Candidate& c) const {
    Linear linear = linear_problem(model_, c.affine, *c.at);
    return solve(linear, robust_ ? few_rounds : 1) ? median(linear.distances)
                                                   : std::numeric_limits<double>::infinity();
  }

  // Keeps the nearest candidates. Among those that are exact up to float rounding, such as many offsets that
  // linear unknowns absorb, candidates in the surface's domain come first.
  void keep_nearest(std::size_t most) {
    constexpr double exact = 1e-6;
    std::stable_sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
      return std::pair(std::fmax(a.distance, exact), a.outside) <
             std::pair(std::fmax(b.distance, exact), b.outside);
    });
    if (candidates_.size() > most) candidates_.resize(most);
  }

  // Adds a candidate at each start of the kind. \param from_u offset, if it is free
  void add(double scale_u, double shear, double scale_v, double from_u, double from_v) {
    const Affine affine{scale_u, shear, 0, scale_v, is_free(4) ? from_u : 0, from_v};
    UvState state;
    state.affine = affine;
    const double outside = outside_of_domain(kind_, model_.whole_convention(state), few_.uvs);
    for (const auto& at : kind_.starts) {
      Candidate c{model_.convention, affine, &at, 0, outside};
      if (robust_) {
        c.distance = distance(c);
      } else {
        set_up(linear_, model_, affine, at);
        c.distance = residual(linear_);
      }
      if (std::isfinite(c.distance)) candidates_.push_back(c);
    }
  }

  // Tries scales, offsets and shears under one convention. A scale that lengths absorb is not searched; if
  // the offset is, the scale may be any. Lengths that absorb scale and offset of v may still be out of range,
  // such as the inner radius of a disk whose v does not begin at 0, or the radius of a cone beyond its apex.
  // With v from 0 to 1 this does not happen.
  void look_under(const UvConvention& convention, std::span<const double> sheared) {
    const std::vector<double> scales{1, 0.5, 2, 0.25, 0.1, 0.75, 1.5, 3}, turns{0, 0.25, 0.5, 0.75},
        shears{-2, -1, -0.5, 0.5, 1, 2};
    model_.convention = convention;
    std::vector<double> u, v;
    for (const auto& stored : points_.uvs) {
      const Vec2<double> uv = convention.surface_uv(stored);
      u.push_back(uv.x), v.push_back(uv.y);
    }
    const std::vector<Unit> plain{{}},
        units_u = is_free(0) || is_free(4) ? units(kind_.coordinates[0], u) : plain,
        units_v = units(kind_.coordinates[1], v);
    const auto add_in_units = [&](double su, double shear, double sv, double offset) {
      for (const Unit& for_u : units_u)
        for (const Unit& for_v : units_v) {
          const double scale_u = su * for_u.scale, scale_v = sv * for_v.scale;
          add(scale_u, shear, scale_v, -scale_u * for_u.from, offset - scale_v * for_v.from);
        }
    };
    for (const double su : choices(0, scales))
      for (const double sv : choices(3, scales))
        for (const double offset : choices(5, turns)) add_in_units(su, 0, sv, offset);
    if (!is_free(1)) return;
    for (const double shear : shears) add_in_units(1, shear, 1, 0);
    // Along stored (slope, 1) the surface's u is constant; the convention maps both.
    const auto& m = convention.affine;
    for (const double slope : sheared) {
      const double along_u = m[0] * slope + m[1], along_v = m[2] * slope + m[3];
      if (along_v == 0) continue;
      const double shear = -along_u / along_v;
      std::vector<double> straight;
      for (std::size_t i = 0; i < u.size(); ++i) straight.push_back(u[i] + shear * v[i]);
      for (const Unit& unit : units(kind_.coordinates[0], straight))
        add(unit.scale, unit.scale * shear, 1, -unit.scale * unit.from, 0);
    }
  }

  // The candidate with its u shifted by `turn`; none if the linear problem has no solution.
  std::optional<UvStart> start_of(const Candidate& c, double turn) const {
    UvModel m = model_of(kind_, points_, c.convention, held_);
    m.free_affine = free_;
    Affine affine = c.affine;
    affine[4] += turn;
    Linear linear = linear_problem(m, affine, *c.at);
    if (!solve(linear, robust_ ? many_rounds : 1)) return std::nullopt;
    const UvState state = rigid(m, linear, affine, *c.at, held_, false);
    const double median = median_distance(m, state);
    if (!std::isfinite(median)) return std::nullopt;
    m.points = &all_;
    return UvStart{m, state, median};
  }

  const UvKind& kind_;
  const fit::NormalisedPoints& all_;
  const UvHeld& held_;
  bool robust_;
  fit::NormalisedPoints points_, few_;
  UvModel model_;  // of the examined points
  std::vector<int> free_;
  std::vector<Candidate> candidates_;
  Linear linear_;  // of the current candidate
};

}  // namespace

double outside_of_domain(const UvKind& kind, const UvConvention& map, std::span<const Vec2<double>> stored) {
  double result = 0;
  for (const Vec2<double>& s : stored) {
    const Vec2<double> uv = map.surface_uv(s);
    for (const auto& [coordinate, x] : {std::pair{kind.coordinates[0], uv.x}, {kind.coordinates[1], uv.y}})
      if (coordinate != Coordinate::turn) result = std::max({result, -x, x - 1});
  }
  return result;
}

std::vector<UvStart> affine_starts(const UvKind& kind, const fit::NormalisedPoints& all, const UvHeld& held,
                                   bool robust, std::span<const double> sheared) {
  return AffineSearch(kind, all, held, robust).starts(sheared);
}

}  // namespace darboux
