// SPDX-License-Identifier: Apache-2.0
// One run under the eyes and hands of viewers: takes their calls between two ticks, and keeps the pace.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/run/run_shell.hpp"
#include "sim/operator/desk.hpp"
#include "sim/operator/live_page.hpp"

namespace fovea::sim {

class LiveSession {
 public:
  // Borrows all. `shell` must have a log. `speed`: see desk::WallPace. Begin before the run's threads.
  LiveSession(LivePage& page, run::RunShell& shell, double speed);
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  // The newest findings, or null.
  using Found = std::function<const beliefs::Findings*()>;

  // From the thread that runs the servo. `parts` without its callbacks.
  void Begin(DeskParts parts, Found found);
  // The desk's parts are about to end.
  void End() { desk_.reset(); }

  // Call between two ticks, before the tick at `next_ns`: returns when it may begin by the pace. False: an
  // operator has ended or reset the run. `interrupted`: the run ends for another reason, which viewers are
  // shown; returns at once.
  bool WaitForTick(std::int64_t next_ns, const std::function<bool()>& interrupted);

  [[nodiscard]] LiveEnd end() const { return end_; }

 private:
  void Record(const std::string& what, const std::string& text);
  // `ends`: the run ends, whatever the desk says.
  void ShowState(std::int64_t wall_ns, bool ends);

  LivePage& page_;
  run::RunShell& shell_;
  const double speed_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::int64_t next_state_ns_ = 0;  // by the wall clock
  std::optional<OperatorDesk> desk_;
  Found found_;
  LiveEnd end_ = LiveEnd::kNone;
};

}  // namespace fovea::sim
