// SPDX-License-Identifier: Apache-2.0
// Number of random states that a test tries.
#pragma once

namespace fovea::test {

// Returns `count`; under a sanitizer, which is some twenty times slower, a tenth of it.
constexpr int Repetitions(int count) {
#if defined(FOVEA_SANITIZED)
  return count / 10;
#else
  return count;
#endif
}

}  // namespace fovea::test
