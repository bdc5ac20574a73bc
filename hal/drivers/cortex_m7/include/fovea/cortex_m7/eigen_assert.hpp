// SPDX-License-Identifier: Apache-2.0
// Include this before everything else. A failed Eigen assertion becomes a processor fault, which ends in the
// safe state. The board has no stream for a message.
#pragma once

namespace fovea::cortex_m7 {
[[noreturn]] void FailCheck() noexcept;
}  // namespace fovea::cortex_m7

#define eigen_assert(condition) ((condition) ? static_cast<void>(0) : ::fovea::cortex_m7::FailCheck())
