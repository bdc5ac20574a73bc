// SPDX-License-Identifier: Apache-2.0
// The natural logarithm of our own, for the reasons of math.hpp.
//
// x = m 2^e with m between the root of 1/2 and that of 2; with s = (m - 1) / (m + 1),
// ln m = 2 (s + s^3/3 + s^5/5 + ...), whose term in s^23 is below 1e-18. ln 2 in two parts, so that e ln 2 is
// exact to its last bit. Accuracy, against the C library in long double: below 4e-16 for |ln x| <= 2,
// relative above (tests/core/model/math_test.cpp prints it).
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace fovea::model {

// ln x. NaN unless x is a normal positive number. Real-time: yes.
inline double Log(double x) noexcept {
  constexpr double kRootOfTwo = 0x1.6a09e667f3bcdp+0;
  constexpr double kLn2High = 0x1.62e42fee00000p-1;
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  constexpr std::uint64_t kFraction = (std::uint64_t{1} << 52U) - 1U;
  constexpr std::uint64_t kOne = std::uint64_t{1023} << 52U;
  if (!(x >= std::numeric_limits<double>::min() && x <= std::numeric_limits<double>::max())) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto bits = std::bit_cast<std::uint64_t>(x);
  double exponent = static_cast<double>(static_cast<std::int32_t>(bits >> 52U) - 1023);
  double m = std::bit_cast<double>((bits & kFraction) | kOne);
  if (m > kRootOfTwo) {
    m *= 0.5;
    exponent += 1.0;
  }
  const double s = (m - 1.0) / (m + 1.0);
  const double s2 = s * s;
  double tail = 1.0 / 21.0;
  for (int n = 19; n >= 3; n -= 2) {
    tail = tail * s2 + 1.0 / n;
  }
  return exponent * kLn2High + (2.0 * s + (2.0 * s * s2 * tail + exponent * kLn2Low));
}

}  // namespace fovea::model
