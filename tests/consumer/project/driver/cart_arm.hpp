// A driver to copy: the arm is a cart of one joint that a made-up device moves.
//
// The device speaks over a stream socket, in the byte order of the computer. Each millisecond it sends a
// CartState; it obeys the last CartCommand that it got, and holds gravity and friction by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "fovea/hal/arm.hpp"

struct CartState {
  std::int64_t time_ns;     // CLOCK_MONOTONIC, when the encoder was read
  std::uint64_t count;      // of states since it was switched on
  double position;          // [m]
  double velocity;          // [m/s]
  double force_measured;    // [N]
  double force_in_force;    // of the command that it obeys [N]
  std::uint64_t emergency;  // 1: somebody pressed its button
};

struct CartCommand {
  double force;         // [N]
  std::uint64_t brake;  // 1: brakes on
};

class CartArm final : public fovea::hal::Arm {
 public:
  // Takes over `socket`, which is connected to the device. A state older than `timeout_ns` is none any more.
  CartArm(int socket, std::int64_t timeout_ns) noexcept;
  ~CartArm();

 private:
  fovea::hal::Status DoRead(fovea::hal::ArmState& state) noexcept override;
  fovea::hal::Status DoWrite(const fovea::hal::ArmCommand& command) noexcept override;

  // Everything that has come; kDisconnected when the device has gone.
  fovea::hal::Status TakeAll() noexcept;

  const int socket_;
  const std::int64_t timeout_ns_;
  std::array<std::byte, 64 * sizeof(CartState)> buffer_{};
  std::size_t filled_ = 0;  // of the buffer, with what is no whole state yet
  CartState newest_{};
  bool has_state_ = false;
  std::int64_t came_ns_ = 0;  // when
};
