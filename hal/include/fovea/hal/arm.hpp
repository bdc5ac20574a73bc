// SPDX-License-Identifier: Apache-2.0
// The arm's side of the seam: joint states in, joint torques out.
#pragma once

#include <cstdint>

#include "fovea/hal/status.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::hal {

// What the arm measured at one instant.
struct ArmState {
  std::int64_t stamp_ns = 0;   // encoder sample time, monotonic, in the loop's Clock
  std::uint64_t sequence = 0;  // counts the arm's states from its start; a gap is a lost state
  std::int32_t num_joints = 0;
  JointArray q{};            // [num_joints] joint positions, measured
  JointArray dq{};           // [num_joints] joint velocities, measured
  JointArray tau_meas{};     // [num_joints] link-side joint torques, measured, gravity included
  JointArray tau_applied{};  // [num_joints] the command in force at stamp_ns, gravity and friction excluded
};

// What the servo commands until the next command.
struct ArmCommand {
  std::uint64_t state_sequence = 0;  // the ArmState that this answers
  std::int32_t num_joints = 0;
  JointArray tau_cmd{};  // [num_joints] joint torques; gravity and motor friction excluded: the arm adds them
  bool engage_brakes = false;  // hold the joints mechanically; tau_cmd is zero then
};

// An arm on a bus, on a network, or in a simulator. One thread uses it.
//
// Real-time: Read and Write do not allocate, lock, throw or log. Write never blocks. Read blocks only when
// paces_loop() is true; then it returns once per period of the arm's own clock.
class Arm {
 public:
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  // The newest state of the arm. On any answer but kOk, `state` is left as it was.
  // kTimeout: no new state within two periods. kDisconnected, kClosed, kDeviceFault: see StatusCode.
  // Corrupt sensor values, non-finite ones included, are passed on unchanged: the servo decides.
  [[nodiscard]] Status Read(ArmState& state) noexcept;

  // Puts `command` in force. Refused, with the last command left in force: kInvalidArgument for another
  // number of joints, kNonFinite for a torque that is not finite.
  [[nodiscard]] Status Write(const ArmCommand& command) noexcept;

  [[nodiscard]] int num_joints() const noexcept { return num_joints_; }
  // True when Read waits for the arm's own clock (a robot that sends its state every millisecond).
  [[nodiscard]] bool paces_loop() const noexcept { return paces_loop_; }

 protected:
  Arm(int num_joints, bool paces_loop) noexcept : num_joints_(num_joints), paces_loop_(paces_loop) {}
  ~Arm() = default;

 private:
  virtual Status DoRead(ArmState& state) noexcept = 0;
  virtual Status DoWrite(const ArmCommand& command) noexcept = 0;

  int num_joints_;
  bool paces_loop_;
};

}  // namespace fovea::hal
