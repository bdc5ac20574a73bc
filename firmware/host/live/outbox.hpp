// SPDX-License-Identifier: Apache-2.0
// Messages that wait for one viewer: bounded. Pictures are dropped first, then plots, and nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/server.hpp"

namespace fovea::live {

// A message to one viewer. The viewers share the payload.
struct Outgoing {
  bool is_text = false;
  std::string head;                            // the whole text, or a binary message's head
  std::shared_ptr<const std::string> payload;  // null: none
  Weight weight = Weight::kEssential;

  [[nodiscard]] std::size_t bytes() const { return head.size() + (payload ? payload->size() : 0); }
};

class Outbox {
 public:
  explicit Outbox(const Limits& limits) : limits_(limits) {}

  // Adds the message, in order. Drops older pictures for a picture, and older plots for a plot. False when
  // there is no room for an essential message: then the viewer cannot be served any more.
  [[nodiscard]] bool Add(Outgoing message);
  // The oldest message.
  std::optional<Outgoing> Take();

  [[nodiscard]] bool empty() const;
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::uint64_t dropped_pictures() const { return dropped_pictures_; }
  [[nodiscard]] std::uint64_t dropped_plots() const { return dropped_plots_; }

 private:
  struct Entry {
    std::uint64_t number = 0;  // in the order of Add
    Outgoing message;
  };
  struct Queue {
    std::deque<Entry> entries;
    std::size_t bytes = 0;
  };

  Queue& QueueOf(Weight weight) { return queues_[static_cast<std::size_t>(weight)]; }
  static Outgoing TakeFrom(Queue& queue);

  const Limits& limits_;
  std::array<Queue, 3> queues_;  // by weight
  std::uint64_t next_ = 0;
  std::uint64_t dropped_pictures_ = 0;
  std::uint64_t dropped_plots_ = 0;
};

}  // namespace fovea::live
