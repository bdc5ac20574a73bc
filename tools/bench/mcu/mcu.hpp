// `fovea-bench mcu`: what the servo takes of a Cortex-M7: instructions, stack, flash and RAM.
#pragma once

namespace fovea::bench {

struct McuArguments {
  double seconds = 4.0;  // simulated, of `ball`; of `square` a quarter
  bool json = false;
};

int RunMcu(const McuArguments& arguments);

}  // namespace fovea::bench
