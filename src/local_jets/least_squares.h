// Least-squares polynomials of two variables, each with its error: docs/theory/local-jets.md has the
// formulas. Plain arithmetic over a number type, which may be SIMD lanes with a neighbourhood each; compiled
// for several instruction sets, and so without any function that those would share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include <darboux/elementary.h>

namespace darboux {

// A polynomial of two variables with `dims` components, fitted to values by least squares, together with that
// of the next degree, from which the error is judged. One QR serves both: the columns are sorted by degree,
// so that what comes first in R and in Qᵀ values is the fit of the lower degree.
template <int degree, int dims, class S>
class LeastSquares {
 public:
  static constexpr int N = (degree + 1) * (degree + 2) / 2, M = N + degree + 2;  // coefficients of the two
  static constexpr int jet = 6;                                                  // those up to degree 2
  static constexpr double worst_condition = 1e12;  // from there on the points determine no polynomial
  struct Given {
    S root_of_weight, x, y, values[dims];
  };
  struct Functional {  // of the coefficients up to degree 2
    S of[jet];
  };
  struct Gain {
    S of[M];
  };

  // Of n values, to be filled in by the caller. One that is zero, with zero weight, has no effect.
  Given* resize(std::size_t n) {
    n_ = n;
    rows_ = std::max<std::size_t>(n, columns + 1);
    if (rows_ > given_.size()) {
      given_.resize(rows_);
      system_.resize(rows_ * width);
    }
    return given_.data();
  }

  // \param count of the values \param total the sum of their weights
  void solve(const S& count, const S& total) {
    using std::sqrt;
    fill();
    for_each_column<columns>([this](auto start, int k) { this->template reflect<start>(k); });
    invert();
    count_ = count;
    residual_rms_ = sqrt(S((squared_norm(N, M) + squared_norm(M, columns)) / total));
    condition_ = condition_of<N>();
    known_ = select(count >= S(M + 3) && condition_of<M>() < S(worst_condition), S(1), S(0));
  }

  // Infinite if the points determine nothing.
  const S& condition() const { return condition_; }
  const S& residual_rms() const { return residual_rms_; }

  // The coefficient of x^i y^j up to degree 2, in the order 1, x, y, x², xy, y².
  S coefficient(int k, int dim) const {
    S sum = inverse_[k][k] * r_[k][M + dim];
    for (int j = k + 1; j < N; ++j) sum = sum + inverse_[j][k] * r_[j][M + dim];
    return k == 4 ? S(S(root_of_two) * sum) : sum;
  }

  // The fitted f · coefficients is this times Qᵀ values: the contribution of each degree.
  Gain gain(Functional f) const {
    f.of[4] = f.of[4] * S(root_of_two);
    Gain gain;
    for (int j = 0; j < M; ++j) {
      gain.of[j] = f.of[0] * inverse_[j][0];
      for (int k = 1; k <= std::min(j, jet - 1); ++k) gain.of[j] = gain.of[j] + f.of[k] * inverse_[j][k];
    }
    return gain;
  }
  // The expected square of the error of f · coefficients · s; infinite if unknown.
  S error(const Gain& gain, const S (&s)[dims]) const {
    S noise(0), change(0), hidden(0), all(0), highest(0);
    for (int i = M; i < columns; ++i) noise = noise + squared(along(i, s));
    for (int i = N; i < M; ++i) {
      const S next = along(i, s);
      change = change + gain.of[i] * next;
      hidden = hidden + next * next;
    }
    for (int i = 0; i < M; ++i) all = all + squared(gain.of[i]);
    for (int i = N - degree - 1; i < N; ++i) highest = highest + squared(gain.of[i]);
    // Symmetric neighbours hide the terms of the next degree that have the other parity: assumes a term as
    // large as those of the next degree, as it appears in the highest degree here.
    const S result = noise / (count_ - S(M + 2)) * all + change * change + hidden / S(M - N) * highest;
    return select(known_ > S(0), result, S(infinite));
  }

 private:
  static constexpr double root_of_two = 1.4142135623730951, root_of_three = 1.7320508075688772,
                          root_of_five = 2.23606797749979, root_of_six = 2.449489742783178,
                          root_of_ten = 3.1622776601683795;
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  // [j][i]: the root of j over i.
  static constexpr double root_of_binomial[6][6] = {
      {1},
      {1, 1},
      {1, root_of_two, 1},
      {1, root_of_three, root_of_three, 1},
      {1, 2, root_of_six, 2, 1},
      {1, root_of_five, root_of_ten, root_of_ten, root_of_five, 1}};

  static constexpr int columns = M + dims, width = columns + columns % 2;  // of the polynomial and the values

  static S squared(const S& x) { return x * x; }

  // Monomials sqrt(binomial) x^(j-i) y^i: a rotation of (x, y) rotates those of one degree.
  void fill() {
    for (std::size_t i = 0; i < n_; ++i) {
      const Given& given = given_[i];
      S* const row = &system_[i * width];
      S x[degree + 2], y[degree + 2];  // their powers
      x[0] = given.root_of_weight;
      y[0] = S(1);
      for (int j = 1; j < degree + 2; ++j) {
        x[j] = x[j - 1] * given.x;
        y[j] = y[j - 1] * given.y;
      }
      for (int j = 0, column = 0; j < degree + 2; ++j)
        for (int k = 0; k <= j; ++k) row[column++] = S(root_of_binomial[j][k]) * (x[j - k] * y[k]);
      for (int k = 0; k < dims; ++k) row[M + k] = given.root_of_weight * given.values[k];
      if (width > columns) row[columns] = S(0);
    }
    // Rows of zeros below the points do not change any least-squares polynomial.
    std::fill(system_.begin() + static_cast<std::ptrdiff_t>(n_ * width),
              system_.begin() + static_cast<std::ptrdiff_t>(rows_ * width), S(0));
  }

  // Calls f(start, k) for k = 0 ... n - 1, start the last multiple of `step` not above k, as a constant:
  // loops from there, or up to the next, have few lengths, each known to the compiler, so that the sums of
  // all columns stay in registers, side by side.
  static constexpr int step = 6;
  template <int n, int start = 0, class F>
  static void for_each_column(F f) {
    for (int k = start; k < std::min(start + step, n); ++k) f(std::integral_constant<int, start>(), k);
    if constexpr (start + step < n) for_each_column<n, start + step>(f);
  }

  // The number of columns processed at once: as many as the registers hold.
  template <int from>
  static constexpr int block = detail::Lanewise<S> ? std::min(step, width - from) : width - from;
  template <int from>
  struct Sums {
    S of[block<from>];
  };

  // The products of the part of column k below the diagonal with the columns from `from` on.
  template <int from>
  Sums<from> products(int k) const {
    Sums<from> sum{};
    for (std::size_t i = static_cast<std::size_t>(k) + 1; i < rows_; ++i) {
      const S* const row = &system_[i * width];
      const S v = row[k];
#pragma GCC unroll 24
      for (int j = 0; j < block<from>; ++j) sum.of[j] = sum.of[j] + v * row[from + j];
    }
    return sum;
  }
  // x - v (v·x) factor, v in column k. \param sum products(k), not needed any more
  template <int from>
  void subtract(int k, Sums<from>& sum, const S& factor) {
    S* const head = &system_[static_cast<std::size_t>(k) * width];
    const S v0 = head[k];
#pragma GCC unroll 24
    for (int j = 0; j < block<from>; ++j) sum.of[j] = factor * (sum.of[j] + v0 * head[from + j]);
    for (std::size_t i = static_cast<std::size_t>(k); i < rows_; ++i) {
      S* const row = &system_[i * width];
      const S v = row[k];
#pragma GCC unroll 24
      for (int j = 0; j < block<from>; ++j) row[from + j] = row[from + j] - v * sum.of[j];
    }
  }
  template <int from>
  void subtract_from(int k, const S& factor) {
    if constexpr (from < width) {
      Sums<from> sum = products<from>(k);
      subtract<from>(k, sum, factor);
      subtract_from<from + block<from>>(k, factor);
    }
  }

  // Householder's reflection of column k; its row of R goes to r_. The rest of the column is no longer used
  // and may change.
  template <int from>
  void reflect(int k) {
    using std::sqrt;
    Sums<from> sum = products<from>(k);
    S* const row = &system_[static_cast<std::size_t>(k) * width];
    const S head = row[k], below = sum.of[k - from];
    const S size = detail::with_sign_of(head, sqrt(S(head * head + below))), v0 = head + size;
    const auto reflects = below > S(std::numeric_limits<double>::min());
    const S factor = select(reflects, S(1) / (size * v0), S(0));
    row[k] = v0;
    subtract_from<from + block<from>>(k, factor);
    // Column k is in these, so they come last; head is in place of v0 times its own.
    subtract<from>(k, sum, factor);
    for (int j = k + 1; j < columns; ++j) r_[k][j] = row[j];
    r_[k][k] = select(reflects, -size, head);
  }

  // Column by column. A zero on the diagonal invalidates its column and those to the right, no other.
  void invert() {
    inverse_[0][0] = S(1) / r_[0][0];
    for_each_column<M>([this](auto start, int j) {
      if (j == 0) return;
      constexpr int length = std::min(start + step, M);
      S sum[length];
      for (int i = 0; i < length; ++i) sum[i] = r_[0][j] * inverse_[0][i];
      for (int k = 1; k < j; ++k) {
        const S factor = r_[k][j];
        for (int i = 0; i < length; ++i) sum[i] = sum[i] + factor * inverse_[k][i];
      }
      const S diagonal = S(1) / r_[j][j];
      for (int i = 0; i < length; ++i) inverse_[j][i] = -diagonal * sum[i];
      inverse_[j][j] = diagonal;
    });
  }

  // Frobenius norms: no rotation of (x, y) changes them.
  template <int size>
  S condition_of() const {
    using std::sqrt;
    S r(0), inverse(0);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i <= j; ++i) {
        r = r + squared(r_[i][j]);
        inverse = inverse + squared(inverse_[j][i]);
      }
    const S condition = sqrt(S(r * inverse));
    return select(condition < S(infinite), condition, S(infinite));
  }

  // Of Qᵀ values, whose rows from N to M belong to the next degree, and those from M on to no polynomial.
  S along(int row, const S (&s)[dims]) const {
    S sum = r_[row][M] * s[0];
    for (int k = 1; k < dims; ++k) sum = sum + r_[row][M + k] * s[k];
    return sum;
  }
  S squared_norm(int from, int to) const {
    S sum(0);
    for (int i = from; i < to; ++i)
      for (int k = 0; k < dims; ++k) sum = sum + squared(r_[i][M + k]);
    return sum;
  }

  std::size_t n_ = 0, rows_ = 0;
  std::vector<Given> given_;
  std::vector<S> system_;        // rows_ rows of `width`
  S r_[columns][columns] = {};   // zero below the diagonal
  S inverse_[M][M + step] = {};  // transposed
  S count_, condition_, residual_rms_, known_;
};

}  // namespace darboux
