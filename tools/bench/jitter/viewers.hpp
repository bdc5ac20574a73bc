// SPDX-License-Identifier: Apache-2.0
// A live page with three viewers that take everything, as a load beside the measured loop.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"

namespace fovea::bench {

class Viewers {
 public:
  static constexpr int kViewers = 3;

  // Begins to serve ticks at 1 kHz and pictures of 640x480 pixels at 30 Hz, as a run's log passes them on, to
  // viewers in this process. std::runtime_error: they cannot connect.
  Viewers();
  ~Viewers();
  Viewers(const Viewers&) = delete;
  Viewers& operator=(const Viewers&) = delete;
  // A viewer was disconnected.
  [[nodiscard]] bool have_left() const { return failed_; }

 private:
  void Feed(const std::stop_token& stop);
  void View(const std::stop_token& stop);

  std::vector<live::Channel> channels_;
  std::unique_ptr<live::Server> server_;
  std::unique_ptr<live::LiveFeed> feed_;
  std::atomic<int> connected_{0};
  std::atomic<bool> failed_{false};
  std::vector<std::jthread> viewers_;
  std::jthread feeder_;
};

}  // namespace fovea::bench
