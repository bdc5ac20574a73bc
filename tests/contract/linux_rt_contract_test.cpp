// SPDX-License-Identifier: Apache-2.0
// Tests the linux_rt drivers against their contracts.
#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/record_ring.hpp"
#include "tests/contract/clock_contract.hpp"
#include "tests/contract/recorder_contract.hpp"

namespace fovea::test {
namespace {

struct MonotonicClockFixture {
  linux_rt::MonotonicClock driver;
  hal::Clock& clock() { return driver; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(MonotonicClock, ClockContract, MonotonicClockFixture);

struct RecordRingFixture {
  linux_rt::RecordRing ring{64};
  hal::Recorder& recorder() { return ring; }
  std::uint64_t dropped() const { return ring.dropped(); }
  std::vector<hal::TickRecord> Taken() {
    std::vector<hal::TickRecord> taken;
    ring.Drain([&](const hal::TickRecord& record) { taken.push_back(record); });
    return taken;
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(RecordRing, RecorderContract, RecordRingFixture);

TEST(RecordRingTest, TwoThreadsTakeOrCountEveryRecord) {
  constexpr std::uint64_t kCount = 200'000;
  linux_rt::RecordRing ring(128);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    hal::TickRecord record;
    for (std::uint64_t i = 0; i < kCount; ++i) {
      record.tick = i;
      record.ddq_cmd.fill(static_cast<double>(i));
      ring.Record(record);
    }
    done = true;
  });
  std::uint64_t taken = 0;
  bool whole = true;
  const auto drain = [&] {
    ring.Drain([&](const hal::TickRecord& record) {
      ++taken;
      whole = whole && record.ddq_cmd[0] == static_cast<double>(record.tick) &&
              record.ddq_cmd[7] == static_cast<double>(record.tick);
    });
  };
  while (!done) {
    drain();
  }
  writer.join();
  drain();
  EXPECT_TRUE(whole);
  EXPECT_EQ(taken + ring.dropped(), kCount);
  EXPECT_GT(taken, 0U);
}

// If `take` throws, its record counts as taken and is not given again.
TEST(RecordRingTest, RecordOfAThrowingTakeIsNotGivenAgain) {
  linux_rt::RecordRing ring(8);
  hal::TickRecord record;
  for (record.tick = 0; record.tick < 4; ++record.tick) {
    ring.Record(record);
  }
  std::vector<std::uint64_t> taken;
  const auto take = [&taken](const hal::TickRecord& r) {
    taken.push_back(r.tick);
    if (r.tick == 1) {
      throw std::runtime_error("no room");
    }
  };
  EXPECT_THROW(ring.Drain(take), std::runtime_error);
  ring.Drain(take);
  EXPECT_EQ(taken, (std::vector<std::uint64_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace fovea::test
