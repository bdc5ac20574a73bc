// SPDX-License-Identifier: Apache-2.0
// Entry point that each harness of this folder defines: runs the code under test on one input of any content.
//
// clang's libFuzzer calls it with generated inputs (preset fuzz); replay.cpp calls it in every build with the
// inputs kept in corpus/. A failed requirement aborts the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fovea::fuzz {

// An assertion that is active in every build.
inline void Require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "requirement failed: %s\n", what);
    std::abort();
  }
}

}  // namespace fovea::fuzz
