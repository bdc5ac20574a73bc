// How much of the stack was ever used.
#pragma once

#include <cstdint>

namespace fovea::cortex_m7 {

// [bytes], from its top to the deepest word that was written. Looks at every word that was not.
[[nodiscard]] std::uint32_t StackBytes() noexcept;

}  // namespace fovea::cortex_m7
