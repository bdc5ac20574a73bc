// SPDX-License-Identifier: Apache-2.0
// Runs after reset, once memory and FPU are ready. The program that links this driver implements it.
#pragma once

namespace fovea::cortex_m7 {

[[noreturn]] void RunProgram();

}  // namespace fovea::cortex_m7
