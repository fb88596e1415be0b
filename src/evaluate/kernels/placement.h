// Places points of a surface by an affine map: the operations of Placed, in lanes. Everything has internal
// linkage: no function of one instruction set may be linked into another.
#pragma once

#include "lanes.h"
#include "work.h"

namespace darboux::kernels {
namespace {

template <class S, class T>
Vec3<S> load(const PlacedBlock<T>& block, std::size_t row, std::size_t i) {
  return {S::load(&block.rows[row][i]), S::load(&block.rows[row + 1][i]), S::load(&block.rows[row + 2][i])};
}
template <class S, class T>
void store(const PlacedBlock<T>& block, std::size_t row, std::size_t i, const Vec3<S>& p) {
  p.x.store(&block.rows[row][i]), p.y.store(&block.rows[row + 1][i]), p.z.store(&block.rows[row + 2][i]);
}

template <class T>
DARBOUX_FLATTEN void place(const PlacedBlock<T>& block) {
  using S = Lanes<T>;
  const auto lifted = [](const Vec3<T>& a) { return Vec3<S>{S(a.x), S(a.y), S(a.z)}; };
  const AffineMap<T>& map = *block.map;
  const typename AffineMap<T>::template NormalMap<S> normals{
      lifted(block.normals->x), lifted(block.normals->y), lifted(block.normals->z), S(block.normals->sign)};
  for (std::size_t i = 0; i < block.count; i += S::lanes) {
    diverged = false;
    S sum(T(0));
    const auto put = [&](std::size_t row, const Vec3<S>& p) {
      store(block, row, i, p);
      sum = sum + (p.x + p.y + p.z);
    };
    if (block.frames) {
      const Frame<S> f = map.frame(Frame<S>{load<S>(block, tangent_row, i),
                                            {},
                                            load<S>(block, normal_row, i),
                                            S::load(&block.rows[handedness_row][i])},
                                   normals);
      put(tangent_row, f.t);
      put(bitangent_row, f.b);
      put(normal_row, f.n);
      f.handedness.store(&block.rows[handedness_row][i]);
    }
    for (std::size_t k = 0; k < 6; ++k) {
      if ((block.vectors >> k & 1u) == 0) continue;
      const std::size_t row = first_vector_row + 3 * k;
      const Vec3<S> p = load<S>(block, row, i);
      put(row, k == 0 ? map.point(p) : map.linear(p));
    }
    // What is not finite has its status from the single-point functions.
    if (!(sum - sum == S(T(0)))) S::diverge();
    if (diverged)
      for (std::size_t k = 0; k < S::lanes; ++k) block.left[i + k] = true;
  }
}

}  // namespace
}  // namespace darboux::kernels
