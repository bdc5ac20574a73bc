// SPDX-License-Identifier: Apache-2.0
// A bounded ring from one thread to another: one writer, one reader, no locks. Values that find it full are
// dropped and counted.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fovea::linux_rt {

template <typename T>
class BoundedRing {
 public:
  // Room for `capacity` values [>= 1], allocated and touched here.
  explicit BoundedRing(std::size_t capacity) : values_(capacity > 0 ? capacity : 1) {}

  // From the writing thread. Real-time: yes.
  void Push(const T& value) noexcept {
    Fill([&value](T& place) { place = value; });
  }

  // The same, but `fill(place)` writes the value in its place, which contains an older value. Real-time: yes,
  // if `fill` is.
  template <typename Make>
  void Fill(const Make& fill) noexcept {
    const std::uint64_t at = written_.load(std::memory_order_relaxed);
    if (!HasRoom()) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    fill(values_[at % values_.size()]);
    written_.store(at + 1, std::memory_order_release);
  }

  // From the writing thread: whether there is room for the next Push.
  [[nodiscard]] bool HasRoom() const noexcept {
    return written_.load(std::memory_order_relaxed) - read_.load(std::memory_order_acquire) < values_.size();
  }

  // From the reading thread: a mark after the values now in the ring, for Drain.
  [[nodiscard]] std::uint64_t End() const noexcept { return written_.load(std::memory_order_acquire); }

  // From the reading thread: calls `take(value)` for every value before the mark, oldest first. Returns
  // their number. If `take` throws, that value is removed, and those behind it stay.
  template <typename Take>
  std::size_t Drain(std::uint64_t end, Take&& take) {
    const std::uint64_t begin = read_.load(std::memory_order_relaxed);
    for (std::uint64_t next = begin; next != end; ++next) {
      const Taken taken{read_, next + 1};
      take(values_[next % values_.size()]);
    }
    return end - begin;
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  // Frees the place, even if `take` throws.
  struct Taken {
    std::atomic<std::uint64_t>& read;
    std::uint64_t next;
    ~Taken() { read.store(next, std::memory_order_release); }
  };

  std::vector<T> values_;
  alignas(64) std::atomic<std::uint64_t> written_{0};
  alignas(64) std::atomic<std::uint64_t> read_{0};
  alignas(64) std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace fovea::linux_rt
