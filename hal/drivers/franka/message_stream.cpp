// SPDX-License-Identifier: Apache-2.0
#include "fovea/franka/message_stream.hpp"

#include <algorithm>

namespace fovea::franka {

MessageStream::Next MessageStream::Take(TcpConnection& from, Header& header,
                                        std::span<const std::byte>& payload) noexcept {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(taken_),
            bytes_.begin() + static_cast<std::ptrdiff_t>(filled_), bytes_.begin());
  filled_ -= taken_;
  taken_ = 0;
  std::size_t got = 0;
  const Received received = from.Receive(std::span(bytes_).subspan(filled_), got);
  filled_ += received == Received::kSome ? got : 0;
  const auto there = std::span<const std::byte>(bytes_).first(filled_);
  if (Header next; Decode(there, next)) {
    if (next.size < kHeaderSize || next.size > kCapacity ||
        static_cast<std::uint32_t>(next.command) >= kCommands) {
      return Next::kGarbage;
    }
    if (next.size <= filled_) {
      header = next;
      payload = there.subspan(kHeaderSize, next.size - kHeaderSize);
      taken_ = next.size;
      return Next::kMessage;
    }
  }
  return received == Received::kClosed ? Next::kClosed : Next::kNothing;
}

}  // namespace fovea::franka
