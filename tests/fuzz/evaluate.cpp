// Evaluation over arbitrary bit patterns, of u, v and of parameters: it is total. A frame is unit and
// orthogonal, or flagged.
#include <cmath>

#include <darboux/any_surface.h>

#include "support.h"

namespace {

using namespace darboux;

// Where a frame is given, single vectors are of unit length and at right angles.
void check_frame(const Frame<double>& f) {
  constexpr Status excuses =
      Status::no_frame | Status::non_finite_input | Status::overflow | Status::ill_conditioned;
  if (has(f.status, excuses)) return;
  const auto near = [](double a, double b) {
    return std::fabs(a - b) < 1e-6;
  };  // half the digits: ill_conditioned
  fuzz::expect(near(dot(f.t, f.t), 1) && near(dot(f.b, f.b), 1) && near(dot(f.n, f.n), 1), "unit vectors");
  fuzz::expect(near(dot(f.t, f.b), 0) && near(dot(f.t, f.n), 0) && near(dot(f.b, f.n), 0), "right angles");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  const auto& all = all_surfaces();
  const AnySurface& plain = all[bytes.take<std::uint8_t>() % all.size()];
  std::vector<double> values;
  const bool changed = bytes.take<std::uint8_t>() % 2 == 1;
  for (const ParameterValue& p : plain.parameters())
    values.push_back(changed ? bytes.take<double>() : p.value);
  fuzz::may_refuse([&] {
    const AnySurface surface = changed ? plain.with(values) : plain;
    do {
      const auto u = bytes.take<double>(), v = bytes.take<double>();
      const Frame<double> frame = surface.frame(u, v);
      if (!changed) check_frame(frame);
      if (!std::isfinite(u) || !std::isfinite(v))
        fuzz::expect(has(frame.status, Status::non_finite_input), "NaN and infinity are flagged");
      static_cast<void>(surface.sample_in_float(static_cast<float>(u), static_cast<float>(v)));
      static_cast<void>(surface.curvature(u, v, surface.jet(u, v), frame));
    } while (!bytes.empty());
  });
  return 0;
}
