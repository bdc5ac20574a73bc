// Which starts a servo is judged by: those that nobody can have tuned it on.
//
// A servo that was changed while somebody looked at the starts of a seed has learned them. So seeds below
// kFirstJudgingSeed are there to look at while the servo is worked on, and figures are quoted over a judging
// seed: it follows from the servo library's hash, so that each change of the servo gives starts that are new.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace fovea::atlas {

inline constexpr int kFirstJudgingSeed = 1000;

// Of the library with this SHA-256, in hexadecimal: kFirstJudgingSeed up to 2^28 more.
[[nodiscard]] inline int JudgingSeed(const std::string& servo_hash) {
  return kFirstJudgingSeed + static_cast<int>(std::strtol(servo_hash.substr(0, 7).c_str(), nullptr, 16));
}

// What starts of `seed` say of the servo with this hash.
[[nodiscard]] inline const char* KindOfSeed(std::uint64_t seed, const std::string& servo_hash) {
  if (seed < static_cast<std::uint64_t>(kFirstJudgingSeed)) {
    return "tuning";
  }
  return seed == static_cast<std::uint64_t>(JudgingSeed(servo_hash)) ? "judging" : "given";
}

}  // namespace fovea::atlas
