// Included before everything else: a failed check of Eigen's is a fault of the processor, which ends in the
// safe state, and not a message on a stream that is not there.
#pragma once

namespace fovea::cortex_m7 {
[[noreturn]] void FailCheck() noexcept;
}  // namespace fovea::cortex_m7

#define eigen_assert(condition) ((condition) ? static_cast<void>(0) : ::fovea::cortex_m7::FailCheck())
