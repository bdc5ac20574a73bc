// SPDX-License-Identifier: Apache-2.0
// What a run has published and the server's thread has not yet distributed: bounded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"

namespace fovea::live {

struct Published {
  std::size_t channel = 0;
  std::int64_t stamp_ns = 0;
  std::string payload;
};

class Inbox {
 public:
  explicit Inbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Drops the message where there is no room: pictures may fill half of it, plots three quarters. Latched
  // messages are few, and always have room.
  void Add(Published message, const Channel& channel) {
    const std::lock_guard lock(mutex_);
    const std::size_t quarters = channel.weight == Weight::kPicture ? 2
                                 : channel.weight == Weight::kPlot  ? 3
                                                                    : 4;
    const std::size_t bytes = message.payload.size() + sizeof(Published);
    if (!channel.latched && bytes_ + bytes > most_bytes_ / 4 * quarters) {
      ++dropped_;
      return;
    }
    bytes_ += bytes;
    messages_.push_back(std::move(message));
  }
  std::vector<Published> TakeMessages() {
    const std::lock_guard lock(mutex_);
    bytes_ = 0;
    return std::exchange(messages_, {});
  }

  // Only the newest state counts.
  void SetState(const State& state) {
    const std::lock_guard lock(mutex_);
    state_ = state;
  }
  std::optional<State> TakeState() {
    const std::lock_guard lock(mutex_);
    return std::exchange(state_, std::nullopt);
  }

  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::vector<Published> messages_;
  std::size_t bytes_ = 0;
  std::optional<State> state_;
  std::uint64_t dropped_ = 0;
};

}  // namespace fovea::live
