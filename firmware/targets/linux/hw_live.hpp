// SPDX-License-Identifier: Apache-2.0
// The live page of a run on hardware. All viewers watch, and may hold the arm and end the run. If the program
// allows it, one may also track, recover, change the gains that may change in motion, and lower the speed.
// Nobody can enable motion from a page, and a page does not keep the dead man's switch alive.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/desk/servo_desk.hpp"
#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/log/log_tap.hpp"
#include "firmware/host/run/run_shell.hpp"
#include "firmware/targets/linux/operator_thread.hpp"

namespace fovea::hw {

struct HwLiveOptions {
  bool control = false;
  live::ServerConfig server;  // without page and report
};

class HwLive {
 public:
  // Begins to listen. Throws like live::Server. `name`: of the configuration. `speed_scale`: its
  // robot.speed_scale, with which `servo` was made; viewers may only lower it.
  HwLive(HwLiveOptions options, const std::string& name, const config::ServoConfig& servo, bool has_camera,
         double speed_scale);

  [[nodiscard]] std::string url() const { return server_->url(); }
  // For the log of the run, which feeds the page.
  [[nodiscard]] log::LogTap tap() { return std::bind_front(&live::LiveFeed::Take, feed_.get()); }

  // The next functions from the thread that takes the records.
  // Call once the servo's loop exists. Borrows all. `allow_motion`: as for EndRun. `heard` learns of each
  // word that a viewer has given, like one that was typed.
  void Begin(run::RunShell& shell, RunControl& control, bool allow_motion, const hal::Clock& clock,
             std::function<void(const Heard& heard)> heard);
  void Note(const hal::TickRecord& record);
  // Call often: takes the viewers' calls, and shows them the state. `findings`: the newest, or null.
  void Attend(const beliefs::Findings* findings);

 private:
  [[nodiscard]] live::Answer Do(const live::Call& call);
  template <class Request>
  [[nodiscard]] live::Answer Take(const Request& request);
  [[nodiscard]] live::Answer Take(const live::Hold& request);
  [[nodiscard]] live::Answer Take(const live::Track& request);
  [[nodiscard]] live::Answer Take(const live::Recover& request);
  [[nodiscard]] live::Answer Take(const live::End& request);
  [[nodiscard]] live::Answer Take(const live::SetParameter& request);
  void SetSpeedScale(double scale);
  [[nodiscard]] double MostOf(const live::Parameter& key) const;
  [[nodiscard]] live::Answer Say(Word word);
  void Touch(const std::string& what, const std::string& text);

  struct Parts {
    run::RunShell& shell;
    RunControl& control;
    bool allow_motion;
    const hal::Clock& clock;
    std::function<void(const Heard& heard)> heard;
  };

  const config::ServoConfig servo_;
  const double speed_scale_;
  const std::vector<live::Parameter> parameters_;  // the servo's; robot.speed_scale follows them
  double scale_;                                   // robot.speed_scale now
  std::vector<double> wished_;                     // the last values that viewers asked for
  std::vector<double> asked_;                      // and that the servo was asked for
  std::unique_ptr<live::Server> server_;
  std::unique_ptr<live::LiveFeed> feed_;
  std::optional<Parts> parts_;
  std::optional<desk::ServoDesk> desk_;
  std::int64_t begin_ns_ = 0;  // stamp of the first record
  std::int64_t now_ns_ = 0;    // of the last one
};

}  // namespace fovea::hw
