// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/tick_meter.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"

namespace fovea::linux_rt {
namespace {

std::int64_t ThreadPageFaults() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

}  // namespace

// Below 2^(kSubBits + 1) a bin is 1 ns wide; above, each power of two has 2^kSubBits bins.
int DurationHistogram::BinOf(std::uint64_t duration_ns) noexcept {
  const int exponent = static_cast<int>(std::bit_width(duration_ns)) - 1 - kSubBits;
  if (exponent <= 0) {
    return static_cast<int>(duration_ns);
  }
  const auto within = static_cast<int>((duration_ns >> exponent) & ((1U << kSubBits) - 1U));
  return ((exponent + 1) << kSubBits) + within;
}

std::uint64_t DurationHistogram::UpperEdge(int bin) noexcept {
  const int exponent = (bin >> kSubBits) - 1;
  if (exponent <= 0) {
    return static_cast<std::uint64_t>(bin);
  }
  const auto within = static_cast<std::uint64_t>(bin & ((1 << kSubBits) - 1));
  return (((std::uint64_t{1} << kSubBits) + within + 1) << exponent) - 1;
}

void DurationHistogram::Add(std::int64_t duration_ns) noexcept {
  const std::int64_t duration = duration_ns < 0 ? 0 : duration_ns;
  ++bins_[static_cast<std::size_t>(BinOf(static_cast<std::uint64_t>(duration)))];
  ++count_;
  max_ns_ = duration > max_ns_ ? duration : max_ns_;
}

std::int64_t DurationHistogram::Percentile(double p) const noexcept {
  if (count_ == 0) {
    return 0;
  }
  const auto rank = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    seen += bins_[static_cast<std::size_t>(bin)];
    if (seen >= rank && seen > 0) {
      const auto edge = static_cast<std::int64_t>(UpperEdge(bin));
      return edge < max_ns_ ? edge : max_ns_;
    }
  }
  return max_ns_;
}

void RecentDurations::Add(std::int64_t duration_ns) noexcept {
  const std::uint64_t at = added_.load(std::memory_order_relaxed);
  durations_ns_[at % kMost].store(duration_ns, std::memory_order_relaxed);
  added_.store(at + 1, std::memory_order_release);
}

// If the other thread comes round while this one reads, some durations are newer than the summary's time.
std::optional<RecentDurations::Summary> RecentDurations::TakeNew() noexcept {
  const std::uint64_t added = added_.load(std::memory_order_acquire);
  const auto count = static_cast<std::ptrdiff_t>(std::min(added - looked_at_, kMost));
  looked_at_ = added;
  if (count == 0) {
    return std::nullopt;
  }
  std::array<std::int64_t, kMost> sorted;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::uint64_t at = added - static_cast<std::uint64_t>(count - i);
    sorted[static_cast<std::size_t>(i)] = durations_ns_[at % kMost].load(std::memory_order_relaxed);
  }
  std::sort(sorted.begin(), sorted.begin() + count);
  return Summary{sorted[static_cast<std::size_t>(count / 2)], sorted[static_cast<std::size_t>(count - 1)]};
}

void TickMeter::Enter() noexcept {
  page_faults_before_ = ThreadPageFaults();
  heap_calls_before_ = CountedHeapCalls();
  start_ns_ = MonotonicNs();
  EnterCountedRegion();
}

void TickMeter::Leave() noexcept {
  LeaveCountedRegion();
  const std::int64_t duration_ns = MonotonicNs() - start_ns_;
  durations_.Add(duration_ns);
  recent_.Add(duration_ns);
  heap_calls_ += CountedHeapCalls() - heap_calls_before_;
  page_faults_ += static_cast<std::uint64_t>(ThreadPageFaults() - page_faults_before_);
}

}  // namespace fovea::linux_rt
