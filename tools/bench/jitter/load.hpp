// SPDX-License-Identifier: Apache-2.0
// Load on the machine, to measure its effect on the measured thread.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tools/bench/jitter/viewers.hpp"

namespace fovea::bench {

// The kinds of load: none; cpu: one busy thread per core; memory: two threads that copy 64 MiB back and
// forth; network: two threads that send datagrams on the loopback without pause; render: the simulator;
// viewers: a live page in this process with three viewers.
inline const std::vector<std::string> kLoads{"none", "cpu", "memory", "network", "render", "viewers"};

// The load runs from construction to destruction.
class Load {
 public:
  // std::runtime_error when the load cannot be started.
  explicit Load(const std::string& kind);
  ~Load();
  // std::runtime_error when viewers have left: the measurement had another load than its name says.
  void Check() const;
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  void StartRender();

  std::atomic<bool> stop_{false};
  std::vector<std::jthread> threads_;
  int render_pid_ = 0;
  std::unique_ptr<Viewers> viewers_;
};

}  // namespace fovea::bench
