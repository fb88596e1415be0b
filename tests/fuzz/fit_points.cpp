// Fits over arbitrary points: a report, whose numbers are finite where it calls itself usable, or a refusal.
#include <cmath>

#include <darboux/fit_points.h>

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::Bytes bytes(data, size);
  PointCloud cloud;
  const bool small = bytes.take<std::uint8_t>() % 2 == 0;
  const auto number = [&] {
    return small ? bytes.take<std::int8_t>() / 16.0 : static_cast<double>(bytes.take<float>());
  };
  while (!bytes.empty() && cloud.positions.size() < 60) {
    const double x = number(), y = number(), z = number();
    cloud.positions.push_back({x, y, z});
  }
  fuzz::may_refuse([&] { static_cast<void>(fit_points(cloud)); });
  return 0;
}
