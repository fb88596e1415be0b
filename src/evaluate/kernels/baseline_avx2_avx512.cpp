// The table of an instruction set, baseline, AVX2 or AVX-512; compiled once for each; DARBOUX_ISA names this
// one. Everything but the table has internal linkage. Its kernels: surface_kernels.h, batch_loop.h.
#include "index_in_catalogue.h"
#include "kernel_list.h"
#include "lanes.h"
#include "layout.h"
#include "placement.h"
#include "work.h"

namespace darboux::kernels {

#define DARBOUX_DECLARE(header) extern const SurfaceKernels DARBOUX_OF_SURFACE(header);
DARBOUX_FOR_EACH_SURFACE_HEADER(DARBOUX_DECLARE)

namespace {

template <Coordinate kind, class T>
DARBOUX_FLATTEN void prepare_all(const T* x, std::size_t count, T* sine, T* cosine) {
  if constexpr (kind != Coordinate::linear)
    for (std::size_t i = 0; i < count; i += Lanes<T>::lanes) {
      const Turn<Lanes<T>> angle = prepare<kind>(Lanes<T>::load(x + i));
      angle.sin.store(sine + i);
      angle.cos.store(cosine + i);
    }
}

template <class T>
constexpr std::array<Prepare<T>, 4> prepare_by_coordinate() {
  return {&prepare_all<Coordinate::linear, T>, &prepare_all<Coordinate::turn, T>,
          &prepare_all<Coordinate::half_turn, T>, &prepare_all<Coordinate::twisted_turn, T>};
}

constexpr std::array<const SurfaceKernels*, most_surfaces> kernels_by_surface() {
  std::array<const SurfaceKernels*, most_surfaces> result{};
#define DARBOUX_ADD(header) result[index_in_catalogue(DARBOUX_STRING(header))] = &DARBOUX_OF_SURFACE(header);
  DARBOUX_FOR_EACH_SURFACE_HEADER(DARBOUX_ADD)
  return result;
}

}  // namespace

extern const Kernels DARBOUX_TABLE(DARBOUX_ISA);
constinit const Kernels DARBOUX_TABLE(DARBOUX_ISA){prepare_by_coordinate<double>(),
                                                   prepare_by_coordinate<float>(),
                                                   kernels_by_surface(),
                                                   &place<double>,
                                                   &place<float>,
                                                   stores_can_pass_caches,
                                                   &stream_lines,
                                                   &fence};

}  // namespace darboux::kernels
