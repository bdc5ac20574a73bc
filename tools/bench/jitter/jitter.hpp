// SPDX-License-Identifier: Apache-2.0
// `fovea-bench jitter`: does this machine keep 1 kHz?
#pragma once

#include <string>

namespace fovea::bench {

struct JitterArguments {
  int seconds = 20;  // of the servo's loop, of the sleeper, and of cyclictest if it is installed
  std::string load = "none";
  std::string policy = "fifo";
  int cpu = -1;                    // processor that the measured thread is bound to; -1: any
  std::string out = "out/jitter";  // folder for jitter.html and jitter.json
  std::string trace;               // file for a timeline; empty: none
  bool json = false;
};

int RunJitter(const JitterArguments& arguments);

}  // namespace fovea::bench
