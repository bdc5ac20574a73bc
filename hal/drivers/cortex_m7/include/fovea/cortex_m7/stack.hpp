// SPDX-License-Identifier: Apache-2.0
// The largest stack use so far.
#pragma once

#include <cstdint>

namespace fovea::cortex_m7 {

// [bytes], from the stack's top to the deepest word that was written. Scans all words that were not.
[[nodiscard]] std::uint32_t StackBytes() noexcept;

}  // namespace fovea::cortex_m7
