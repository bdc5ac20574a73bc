#include "fovea/linux_rt/record_ring.hpp"

namespace fovea::linux_rt {

RecordRing::RecordRing(std::size_t capacity) : records_(capacity > 0 ? capacity : 1) {}

void RecordRing::Record(const hal::TickRecord& record) noexcept {
  const std::uint64_t at = written_.load(std::memory_order_relaxed);
  if (at - read_.load(std::memory_order_acquire) >= records_.size()) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  records_[at % records_.size()] = record;
  written_.store(at + 1, std::memory_order_release);
}

}  // namespace fovea::linux_rt
