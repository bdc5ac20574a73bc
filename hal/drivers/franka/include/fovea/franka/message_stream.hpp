// SPDX-License-Identifier: Apache-2.0
// Cuts a TCP stream into the interface's messages. No heap, bounded.
#pragma once

#include "fovea/franka/messages.hpp"
#include "fovea/franka/sockets.hpp"

namespace fovea::franka {

class MessageStream {
 public:
  enum class Next : std::uint8_t {
    kMessage,  // `header` and `payload` are set; the payload stays as it is until the next call
    kNothing,  // no whole message has arrived
    kClosed,   // the peer has closed
    kGarbage,  // the next bytes are not a message of this interface; the rest cannot be read
  };

  // The next whole message, without waiting. Real-time: yes.
  [[nodiscard]] Next Take(TcpConnection& from, Header& header, std::span<const std::byte>& payload) noexcept;
  void Clear() noexcept { filled_ = taken_ = 0; }
  // Whether an incomplete message has arrived.
  [[nodiscard]] bool HasPart() const noexcept { return filled_ > taken_; }

 private:
  static constexpr std::size_t kCapacity = 1024;  // the longest message has 428 bytes
  std::array<std::byte, kCapacity> bytes_{};
  std::size_t filled_ = 0;
  std::size_t taken_ = 0;  // size of the message returned last
};

}  // namespace fovea::franka
