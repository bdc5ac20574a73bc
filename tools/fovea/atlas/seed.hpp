// SPDX-License-Identifier: Apache-2.0
// Seeds of an atlas. A servo is judged on starts on which nobody can have tuned it.
//
// Whoever changes the servo while looking at the starts of a seed tunes it on them. Seeds below
// kFirstJudgingSeed are for such tuning. Quoted figures use a judging seed. It follows from the hash of the
// servo library, so each change of the servo gives new starts.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace fovea::atlas {

inline constexpr int kFirstJudgingSeed = 1000;

// The judging seed for a library with this SHA-256 in hexadecimal: kFirstJudgingSeed plus less than 2^28.
[[nodiscard]] inline int JudgingSeed(const std::string& servo_hash) {
  return kFirstJudgingSeed + static_cast<int>(std::strtol(servo_hash.substr(0, 7).c_str(), nullptr, 16));
}

// The kind of `seed` for the servo with this hash.
[[nodiscard]] inline const char* KindOfSeed(std::uint64_t seed, const std::string& servo_hash) {
  if (seed < static_cast<std::uint64_t>(kFirstJudgingSeed)) {
    return "tuning";
  }
  return seed == static_cast<std::uint64_t>(JudgingSeed(servo_hash)) ? "judging" : "given";
}

}  // namespace fovea::atlas
