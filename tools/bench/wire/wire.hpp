// SPDX-License-Identifier: Apache-2.0
// `fovea-bench wire`: times the robot's network interface, with server and client on this machine.
#pragma once

#include <string>

namespace fovea::bench {

struct WireArguments {
  double seconds = 10.0;
  std::string pace = "real";
  bool json = false;
};

int RunWire(const WireArguments& arguments);

}  // namespace fovea::bench
