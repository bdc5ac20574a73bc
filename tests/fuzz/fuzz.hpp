// What each file of this folder gives: one input, whatever it is, taken in by the code that has to bear it.
//
// clang's libFuzzer calls it with inputs of its own making (preset fuzz); replay.cpp with those that are kept
// in corpus/, in every build. What must not happen ends the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fovea::fuzz {

// As an assertion, in every build.
inline void Require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "not so: %s\n", what);
    std::abort();
  }
}

}  // namespace fovea::fuzz
