// SPDX-License-Identifier: Apache-2.0
// Drivers whose behaviour a test decides.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <vector>

#include "fovea/hal/arm.hpp"
#include "fovea/hal/camera.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::test {

// Returns `state`, `read_status` and `write_status`; keeps the commands written.
class FakeArm final : public hal::Arm {
 public:
  explicit FakeArm(int num_joints, bool paces_loop = false) : Arm(num_joints, paces_loop) {
    state.num_joints = num_joints;
  }
  hal::ArmState state;
  hal::Status read_status;
  hal::Status write_status;
  std::function<void()> before_read;  // runs at the start of each Read; may be empty
  std::vector<hal::ArmCommand> written;

 private:
  hal::Status DoRead(hal::ArmState& out) noexcept override {
    if (before_read) {
      before_read();
    }
    if (read_status.ok()) {
      out = state;
    }
    return read_status;
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    written.push_back(command);
    state.tau_applied = command.tau_cmd;
    return write_status;
  }
};

// Returns `frames` one after another, then the status `after`.
class FakeCamera final : public hal::Camera {
 public:
  std::deque<hal::Frame> frames;
  hal::Status after{hal::StatusCode::kClosed};

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t) noexcept override {
    if (frames.empty()) {
      return after;
    }
    frame = frames.front();
    frames.pop_front();
    return hal::Status::Ok();
  }
};

// Time jumps to each deadline, plus the next entry of `late_ns`: one entry per wait.
class FakeClock final : public hal::Clock {
 public:
  std::int64_t now_ns = 0;
  std::deque<std::int64_t> late_ns;
  std::vector<std::int64_t> deadlines_ns;

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return now_ns; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    deadlines_ns.push_back(deadline_ns);
    std::int64_t late = 0;
    if (!late_ns.empty()) {
      late = late_ns.front();
      late_ns.pop_front();
    }
    now_ns = std::max(now_ns, deadline_ns + late);
    return hal::Status::Ok();
  }
};

class ListRecorder final : public hal::Recorder {
 public:
  std::vector<hal::TickRecord> records;
  void Record(const hal::TickRecord& record) noexcept override { records.push_back(record); }
};

class NoProbe final : public hal::TickProbe {
 public:
  void Enter() noexcept override {}
  void Leave() noexcept override {}
};

}  // namespace fovea::test
