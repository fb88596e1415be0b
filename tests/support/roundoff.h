/// \file roundoff.h
/// u, half of the distance from 1 to the next double.
#pragma once

namespace darboux::test {

inline constexpr double roundoff = 0x1p-53;

}  // namespace darboux::test
