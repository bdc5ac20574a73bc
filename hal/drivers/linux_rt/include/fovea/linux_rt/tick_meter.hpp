// SPDX-License-Identifier: Apache-2.0
// Measures every tick from outside: its duration, heap calls and page faults.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "fovea/hal/record.hpp"

namespace fovea::linux_rt {

// Durations in bins whose width is 1/64 of their value: percentiles to 1.6 %, any duration, no heap.
class DurationHistogram {
 public:
  void Add(std::int64_t duration_ns) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::int64_t max_ns() const noexcept { return max_ns_; }
  // The duration that the share `p` [0, 1] of all durations does not exceed (a bin's upper edge); 0 when
  // there are none.
  [[nodiscard]] std::int64_t Percentile(double p) const noexcept;
  // Calls `take(upper_edge_ns, count)` for each bin that holds something, shortest durations first.
  template <typename Take>
  void ForEach(Take&& take) const {
    for (int bin = 0; bin < kBins; ++bin) {
      if (const std::uint64_t count = bins_[static_cast<std::size_t>(bin)]; count > 0) {
        take(static_cast<std::int64_t>(UpperEdge(bin)), count);
      }
    }
  }

 private:
  static constexpr int kSubBits = 6;
  static constexpr int kBins = (64 - kSubBits) << kSubBits;
  [[nodiscard]] static int BinOf(std::uint64_t duration_ns) noexcept;
  [[nodiscard]] static std::uint64_t UpperEdge(int bin) noexcept;

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0;
};

// The last durations, for one thread that looks while another adds. Neither waits.
class RecentDurations {
 public:
  struct Summary {
    std::int64_t median_ns = 0;
    std::int64_t max_ns = 0;
  };

  void Add(std::int64_t duration_ns) noexcept;
  // Of the durations that came since the last call, or of the last kMost. Nothing if none came.
  [[nodiscard]] std::optional<Summary> TakeNew() noexcept;

 private:
  static constexpr std::uint64_t kMost = 512;

  std::array<std::atomic<std::int64_t>, kMost> durations_ns_{};
  std::atomic<std::uint64_t> added_{0};
  std::uint64_t looked_at_ = 0;  // of the thread that looks
};

// Reads time and page faults just outside the counted region, so that the measurement does not count itself.
class TickMeter final : public hal::TickProbe {
 public:
  void Enter() noexcept override;
  void Leave() noexcept override;

  [[nodiscard]] const DurationHistogram& durations() const noexcept { return durations_; }
  [[nodiscard]] RecentDurations& recent() noexcept { return recent_; }
  [[nodiscard]] std::uint64_t heap_calls() const noexcept { return heap_calls_; }
  [[nodiscard]] std::uint64_t page_faults() const noexcept { return page_faults_; }

 private:
  DurationHistogram durations_;
  RecentDurations recent_;
  std::uint64_t heap_calls_ = 0;
  std::uint64_t page_faults_ = 0;
  std::uint64_t heap_calls_before_ = 0;
  std::int64_t page_faults_before_ = 0;
  std::int64_t start_ns_ = 0;
};

}  // namespace fovea::linux_rt
