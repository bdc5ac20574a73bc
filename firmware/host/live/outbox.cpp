// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/outbox.hpp"

#include <algorithm>
#include <utility>

namespace fovea::live {

bool Outbox::Add(Outgoing message) {
  Queue& queue = QueueOf(message.weight);
  const std::size_t bytes = message.bytes();
  switch (message.weight) {
    case Weight::kEssential:
      if (queue.bytes + bytes > limits_.essential_bytes) {
        return false;
      }
      break;
    case Weight::kPlot:
      for (; !queue.entries.empty() && queue.bytes + bytes > limits_.plot_bytes; ++dropped_plots_) {
        TakeFrom(queue);
      }
      break;
    case Weight::kPicture:
      for (; queue.entries.size() >= limits_.pictures; ++dropped_pictures_) {
        TakeFrom(queue);
      }
      break;
  }
  queue.bytes += bytes;
  queue.entries.push_back({next_++, std::move(message)});
  return true;
}

std::optional<Outgoing> Outbox::Take() {
  Queue* oldest = nullptr;
  for (Queue& queue : queues_) {
    if (!queue.entries.empty() &&
        (oldest == nullptr || queue.entries.front().number < oldest->entries.front().number)) {
      oldest = &queue;
    }
  }
  return oldest == nullptr ? std::nullopt : std::optional(TakeFrom(*oldest));
}

Outgoing Outbox::TakeFrom(Queue& queue) {
  Outgoing message = std::move(queue.entries.front().message);
  queue.entries.pop_front();
  queue.bytes -= message.bytes();
  return message;
}

bool Outbox::empty() const {
  return std::all_of(queues_.begin(), queues_.end(),
                     [](const Queue& queue) { return queue.entries.empty(); });
}

std::size_t Outbox::bytes() const {
  std::size_t sum = 0;
  for (const Queue& queue : queues_) {
    sum += queue.bytes;
  }
  return sum;
}

}  // namespace fovea::live
