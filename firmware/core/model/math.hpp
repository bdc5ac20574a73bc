// SPDX-License-Identifier: Apache-2.0
// sin, cos and atan2 of our own, so that a PC and a microcontroller compute the same bits.
//
// Only additions, multiplications and divisions in a fixed order: the result depends on nothing but IEEE
// 754 double arithmetic without contraction (fovea_bits). Polynomials: Chebyshev fits of our own to
// (sin(x)/x - 1)/x^2, (cos(x) - 1 + x^2/2)/x^4 and (atan(x)/x - 1)/x^2, in x^2.
// Argument reduction: Cody and Waite (1980), pi/2 in three parts.
//
// Accuracy, against the C library in long double (tests/core/model/math_test.cpp prints it):
//   SinCos  |x| <= 1e5: absolute error below 1.2e-16
//   Atan2   absolute error below 4.5e-16
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace fovea::model {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kSinCosMaxArgument = 1e5;  // [rad]

struct SinCosResult {
  double sin;
  double cos;
};

// sin and cos of `x` [rad]. NaN for a NaN and for |x| > kSinCosMaxArgument: an angle of that size is a bug,
// and the servo latches a fault on NaN. Real-time: yes.
inline SinCosResult SinCos(double x) noexcept {
  if (!(x >= -kSinCosMaxArgument && x <= kSinCosMaxArgument)) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    return {kNan, kNan};
  }
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  constexpr double kHalfPi1 = 0x1.921fb54400000p+0;   // the first 33 bits of pi/2
  constexpr double kHalfPi2 = 0x1.0b4611a600000p-34;  // the next 33
  constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;  // the rest
  constexpr double kRound = 0x1.8p52;                 // adding and subtracting it rounds to an integer
  const double turns = (x * kTwoOverPi + kRound) - kRound;
  // r is the angle within its quarter turn, tail its rounding error.
  const double head = x - turns * kHalfPi1;
  const double r = head - turns * kHalfPi2;
  const double tail = ((head - r) - turns * kHalfPi2) - turns * kHalfPi3;
  const double z = r * r;
  const double p =
      -0x1.5555555555555p-3 +
      z * (0x1.1111111110bb2p-7 +
           z * (-0x1.a01a019e83816p-13 +
                z * (0x1.71de379654304p-19 + z * (-0x1.ae600aca92c64p-26 + z * 0x1.5e0b05bff20f2p-33))));
  const double q =
      0x1.5555555555555p-5 +
      z * (-0x1.6c16c16c16967p-10 +
           z * (0x1.a01a019f4e9b4p-16 +
                z * (-0x1.27e4fa17bf139p-22 + z * (0x1.1eeb68cd22f56p-29 + z * -0x1.907d8f29fe831p-37))));
  const double half_z = 0.5 * z;
  const double c_head = 1.0 - half_z;
  const double s = r + (r * z * p + tail * c_head);
  const double c = c_head + (((1.0 - c_head) - half_z) + (z * z * q - r * tail));
  switch (static_cast<std::int32_t>(turns) & 3) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

// Angle of the vector (x, y) against the x axis [rad], in [-pi, pi]; 0 for the null vector, NaN for a NaN,
// infinite or huge (> 8e307) argument. Real-time: yes.
inline double Atan2(double y, double x) noexcept {
  const double ax = x < 0 ? -x : x;
  const double ay = y < 0 ? -y : y;
  constexpr double kMax = std::numeric_limits<double>::max() / 2;  // so that small + big stays finite
  if (!(ax <= kMax && ay <= kMax)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double big = ax > ay ? ax : ay;
  const double small = ax > ay ? ay : ax;
  if (big == 0.0) {
    return 0.0;
  }
  // atan(small/big) in [0, pi/4]; above tan(pi/8) reduced by pi/4, so that the polynomial sees |u| <= 0.4143.
  constexpr double kTanEighthPi = 0.41421356237309503;
  const bool upper = small > kTanEighthPi * big;
  const double u = upper ? (small - big) / (small + big) : small / big;
  const double z = u * u;
  double p = -0x1.3a2b7a07caea9p-6;
  p = 0x1.41603647c7a7cp-5 + z * p;
  p = -0x1.a098bb6ba4941p-5 + z * p;
  p = 0x1.dfe61e80903d2p-5 + z * p;
  p = -0x1.10fa75382537fp-4 + z * p;
  p = 0x1.3b1262d95579ep-4 + z * p;
  p = -0x1.745d0b26b83e7p-4 + z * p;
  p = 0x1.c71c7185314cbp-4 + z * p;
  p = -0x1.24924924360cbp-3 + z * p;
  p = 0x1.999999999934ap-3 + z * p;
  p = -0x1.5555555555555p-2 + z * p;
  double angle = u + u * z * p;
  if (upper) {
    angle = 0.25 * kPi + angle;
  }
  if (ay > ax) {
    angle = 0.5 * kPi - angle;
  }
  if (x < 0) {
    angle = kPi - angle;
  }
  return y < 0 ? -angle : angle;
}

}  // namespace fovea::model
