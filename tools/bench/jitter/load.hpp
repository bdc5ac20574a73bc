// Work beside the measured thread, to see what it does to it.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace fovea::bench {

// The kinds of load: none; cpu: a busy thread on each core; memory: two that copy 64 MiB to and fro; network:
// datagrams on the loopback, as fast as they go; render: the simulator draws pictures, where it is built.
inline const std::vector<std::string> kLoads{"none", "cpu", "memory", "network", "render"};

// Runs from construction to destruction.
class Load {
 public:
  // std::runtime_error when it cannot be brought about here.
  explicit Load(const std::string& kind);
  ~Load();
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  void StartRender();

  std::atomic<bool> stop_{false};
  std::vector<std::jthread> threads_;
  int render_pid_ = 0;
};

}  // namespace fovea::bench
