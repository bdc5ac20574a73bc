// SPDX-License-Identifier: Apache-2.0
// `fovea-bench vision`: detection rate, accuracy and time on pictures with known truth.
#pragma once

#include <string>

namespace fovea::bench {

struct VisionArguments {
  int pictures = 60;  // of each class; a third of them without a target
  int seed = 1;
  std::string target = "all";
  std::string only;  // one class; empty: all
  bool json = false;
};

int RunVision(const VisionArguments& arguments);

}  // namespace fovea::bench
