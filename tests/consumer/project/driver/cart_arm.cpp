// SPDX-License-Identifier: Apache-2.0
#include "cart_arm.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

using fovea::hal::Status;
using fovea::hal::StatusCode;

namespace {

std::int64_t NowNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * fovea::hal::kNsPerSecond + now.tv_nsec;
}

}  // namespace

CartArm::CartArm(int socket, std::int64_t timeout_ns) noexcept
    : Arm(/*num_joints=*/1, /*paces_loop=*/false), socket_(socket), timeout_ns_(timeout_ns) {}

CartArm::~CartArm() { close(socket_); }

Status CartArm::TakeAll() noexcept {
  while (true) {
    const ssize_t got = recv(socket_, buffer_.data() + filled_, buffer_.size() - filled_, MSG_DONTWAIT);
    if (got == 0) {
      return Status(StatusCode::kDisconnected, "cart");
    }
    if (got < 0) {
      return errno == EAGAIN || errno == EINTR ? Status::Ok() : Status(StatusCode::kDisconnected, "cart");
    }
    filled_ += static_cast<std::size_t>(got);
    const std::size_t whole = filled_ / sizeof(CartState);
    if (whole > 0) {  // keep only the newest; the bytes after it begin the next state
      std::memcpy(&newest_, buffer_.data() + (whole - 1) * sizeof(CartState), sizeof(CartState));
      filled_ -= whole * sizeof(CartState);
      std::memmove(buffer_.data(), buffer_.data() + whole * sizeof(CartState), filled_);
      has_state_ = true;
      came_ns_ = NowNs();
    }
  }
}

Status CartArm::DoRead(fovea::hal::ArmState& state) noexcept {
  if (const Status status = TakeAll(); !status.ok()) {
    return status;
  }
  if (!has_state_ || NowNs() - came_ns_ > timeout_ns_) {
    return Status(StatusCode::kTimeout, "cart");
  }
  if (newest_.emergency != 0) {
    return Status(StatusCode::kDeviceFault, "cart: emergency stop");
  }
  state = {};  // entries past the last joint are zero
  state.stamp_ns = newest_.time_ns;
  state.sequence = newest_.count;
  state.num_joints = num_joints();
  state.q[0] = newest_.position;
  state.dq[0] = newest_.velocity;
  state.tau_meas[0] = newest_.force_measured;
  state.tau_applied[0] = newest_.force_in_force;
  return Status::Ok();
}

// hal::Arm has checked that there is one torque, and that it is finite.
Status CartArm::DoWrite(const fovea::hal::ArmCommand& command) noexcept {
  const CartCommand out{command.tau_cmd[0], command.engage_brakes ? std::uint64_t{1} : std::uint64_t{0}};
  const ssize_t sent = send(socket_, &out, sizeof(out), MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent == static_cast<ssize_t>(sizeof(out)) ? Status::Ok() : Status(StatusCode::kDisconnected, "cart");
}
