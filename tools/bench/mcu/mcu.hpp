// SPDX-License-Identifier: Apache-2.0
// `fovea-bench mcu`: instructions, stack, flash and RAM of the servo on a Cortex-M7.
#pragma once

namespace fovea::bench {

struct McuArguments {
  double seconds = 4.0;  // simulated time of `ball`; `square` gets a quarter of it
  bool json = false;
};

int RunMcu(const McuArguments& arguments);

}  // namespace fovea::bench
