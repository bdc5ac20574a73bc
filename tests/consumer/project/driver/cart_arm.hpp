// SPDX-License-Identifier: Apache-2.0
// A driver to copy. Its arm is a cart with one joint, moved by an invented device.
//
// The device talks over a stream socket in the computer's byte order. Every millisecond it sends a CartState.
// It obeys the last CartCommand received, and compensates gravity and friction by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "fovea/hal/arm.hpp"

struct CartState {
  std::int64_t time_ns;     // CLOCK_MONOTONIC, when the encoder was read
  std::uint64_t count;      // number of states since power-on
  double position;          // [m]
  double velocity;          // [m/s]
  double force_measured;    // [N]
  double force_in_force;    // of the active command [N]
  std::uint64_t emergency;  // 1: its stop button is pressed
};

struct CartCommand {
  double force;         // [N]
  std::uint64_t brake;  // 1: brakes on
};

class CartArm final : public fovea::hal::Arm {
 public:
  // Takes over `socket`, connected to the device. Read fails when no state came for `timeout_ns`.
  CartArm(int socket, std::int64_t timeout_ns) noexcept;
  ~CartArm();

 private:
  fovea::hal::Status DoRead(fovea::hal::ArmState& state) noexcept override;
  fovea::hal::Status DoWrite(const fovea::hal::ArmCommand& command) noexcept override;

  // Takes all received bytes; kDisconnected when the device closed the line.
  fovea::hal::Status TakeAll() noexcept;

  const int socket_;
  const std::int64_t timeout_ns_;
  std::array<std::byte, 64 * sizeof(CartState)> buffer_{};
  std::size_t filled_ = 0;  // bytes in the buffer; after TakeAll less than one state
  CartState newest_{};
  bool has_state_ = false;
  std::int64_t came_ns_ = 0;  // when newest_ arrived
};
