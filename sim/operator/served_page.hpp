// SPDX-License-Identifier: Apache-2.0
// The live page of a served robot: it shows the bench as it truly is, and lets a viewer touch it. The servo,
// with its own page, runs in the client.
//
// A thread of its own, of low priority, talks to the viewers and makes all messages, as the log of a run
// would. It visits the world between two steps; the robot's thread waits for nobody.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <thread>

#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/run/run_book.hpp"
#include "fovea/hal/camera.hpp"
#include "foxglove/geometry.pb.h"
#include "sim/operator/between_steps.hpp"
#include "sim/operator/served_desk.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class ServedPage {
 public:
  // Begins to listen. Borrows `about` and `world`; the world must be loadable
  // (BulletArmOptions::may_be_loaded). `camera_faults`: see ServedDesk. Throws like live::Server.
  ServedPage(live::ServerConfig config, const RunDescription& about, World& world,
             ServedDesk::CameraFaults camera_faults);
  // Tells the viewers that the serving has ended. After the world's last step.
  ~ServedPage();
  ServedPage(const ServedPage&) = delete;
  ServedPage& operator=(const ServedPage&) = delete;

  // After each step of the world, from its thread.
  void AfterStep();
  // A picture that the camera delivers, from one thread. Copies it, if a viewer watches.
  void AddPicture(const hal::Frame& frame);

  [[nodiscard]] std::string url() const { return server_->url(); }
  // A viewer has ended the serving.
  [[nodiscard]] bool ended() const { return ended_.load(std::memory_order_relaxed); }

 private:
  using Clock = std::chrono::steady_clock;

  void ShowOnce();
  void Run();
  [[nodiscard]] live::Answer Do(const live::Call& call);
  [[nodiscard]] bool AsksToLetGo(const live::Request& request);
  void LetGo();
  void Look();
  void ShowBench();
  void ShowState();
  void ShowStandstill();
  void ShowPicture();
  void Show(const char* topic, std::int64_t stamp_ns, const google::protobuf::Message& message);

  const RunDescription& about_;
  const run::RunFacts facts_;
  World& world_;
  ServedDesk desk_;  // used by the world's thread
  BetweenSteps between_;
  // What shall be let go before the next step, however late that is.
  std::atomic<bool> let_target_go_{false};
  std::atomic<bool> let_arm_go_{false};
  std::unique_ptr<live::Server> server_;
  std::unique_ptr<live::LiveFeed> feed_;
  std::atomic<bool> ended_{false};
  std::atomic<bool> closed_{false};

  std::mutex picture_mutex_;
  cv::Mat picture_;  // the newest, not sent yet; empty: none
  std::int64_t picture_ns_ = 0;

  ServedLook look_;  // written by the world's thread while the page's thread waits for it

  // Used by the page's thread.
  const Clock::time_point begin_ = Clock::now();
  foxglove::FrameTransforms transforms_;
  std::int64_t next_bench_ns_ = 0;  // in the world's time
  bool state_due_ = true;
  Clock::time_point next_state_ = begin_;
  Clock::time_point speed_from_ = begin_;  // the speed is measured from here
  double speed_from_s_ = 0.0;              // in the world's time
  double speed_ = 1.0;                     // of the world's time relative to the clock
  live::State state_;                      // the last that was shown
  std::thread thread_;                     // declared last: it uses the other members
};

}  // namespace fovea::sim
