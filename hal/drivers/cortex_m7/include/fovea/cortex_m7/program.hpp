// What runs after reset, once memory and FPU are ready: given by whoever links this driver.
#pragma once

namespace fovea::cortex_m7 {

[[noreturn]] void RunProgram();

}  // namespace fovea::cortex_m7
