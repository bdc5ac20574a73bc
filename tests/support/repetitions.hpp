// How often a property is tried with random states.
#pragma once

namespace fovea::test {

// `count` as asked for; under a sanitizer, which is some twenty times slower, a tenth of it.
constexpr int Repetitions(int count) {
#if defined(FOVEA_SANITIZED)
  return count / 10;
#else
  return count;
#endif
}

}  // namespace fovea::test
