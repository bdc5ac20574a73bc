// Carries tick records out of the real-time thread: a bounded ring, one writer, one reader, no locks.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "fovea/hal/record.hpp"

namespace fovea::linux_rt {

class RecordRing final : public hal::Recorder {
 public:
  // Room for `capacity` records [>= 1], allocated and touched here.
  explicit RecordRing(std::size_t capacity);

  // From the real-time thread. A record that finds the ring full is dropped and counted.
  void Record(const hal::TickRecord& record) noexcept override;

  // From one other thread: calls `take(record)` for every record that is there, oldest first.
  template <typename Take>
  void Drain(Take&& take) {
    const std::uint64_t end = written_.load(std::memory_order_acquire);
    std::uint64_t next = read_.load(std::memory_order_relaxed);
    for (; next != end; ++next) {
      take(records_[next % records_.size()]);
      read_.store(next + 1, std::memory_order_release);
    }
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::vector<hal::TickRecord> records_;
  alignas(64) std::atomic<std::uint64_t> written_{0};
  alignas(64) std::atomic<std::uint64_t> read_{0};
  alignas(64) std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace fovea::linux_rt
