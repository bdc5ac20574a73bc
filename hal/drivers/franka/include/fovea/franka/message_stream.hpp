// Cuts a TCP stream into the interface's messages. No heap, bounded.
#pragma once

#include "fovea/franka/messages.hpp"
#include "fovea/franka/sockets.hpp"

namespace fovea::franka {

class MessageStream {
 public:
  enum class Next : std::uint8_t {
    kMessage,  // `header` and `payload` are set; the payload stays as it is until the next call
    kNothing,  // no whole message is there
    kClosed,   // the peer has closed
    kGarbage,  // no message of this interface begins here; nothing that follows can be read
  };

  // The next whole message, without waiting. Real-time: yes.
  [[nodiscard]] Next Take(TcpConnection& from, Header& header, std::span<const std::byte>& payload) noexcept;
  void Clear() noexcept { filled_ = taken_ = 0; }
  // Whether the beginning of a message is there, and its end is not.
  [[nodiscard]] bool HasPart() const noexcept { return filled_ > taken_; }

 private:
  static constexpr std::size_t kCapacity = 1024;  // the longest message has 428 bytes
  std::array<std::byte, kCapacity> bytes_{};
  std::size_t filled_ = 0;
  std::size_t taken_ = 0;  // of the message handed out last
};

}  // namespace fovea::franka
