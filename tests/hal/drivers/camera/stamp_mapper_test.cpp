// SPDX-License-Identifier: Apache-2.0
// Maps the stamps of a device clock to the host's clock when the network delay is random.
#include "fovea/camera/stamp_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <random>

#include "fovea/camera/stamp.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::camera {
namespace {

constexpr std::int64_t kTransportNs = 12 * hal::kNsPerMs;
constexpr std::int64_t kFrameNs = hal::kNsPerSecond / 30;

// The device's clock has an offset and gains `drift` seconds per second on the host's.
struct Device {
  double drift = 0.0;
  std::int64_t offset_ns = 0;
  std::mt19937_64 random{7};
  std::exponential_distribution<double> late_ms{1.0 / 2.0};

  [[nodiscard]] std::int64_t Stamp(std::int64_t host_ns) const {
    return offset_ns + host_ns + std::llround(drift * static_cast<double>(host_ns));
  }
  std::int64_t Arrival(std::int64_t host_ns) {
    return host_ns + kTransportNs + static_cast<std::int64_t>(1e6 * late_ms(random));
  }
};

// Largest error [ns] of frames `from` to `to`.
double WorstNs(StampMapper& mapper, Device& device, int from, int to) {
  double worst = 0.0;
  for (int k = 0; k < to; ++k) {
    const std::int64_t true_ns = 1'000'000'007 + k * kFrameNs;
    const std::int64_t mapped_ns = mapper.Map(device.Stamp(true_ns), device.Arrival(true_ns));
    if (k >= from) {
      worst = std::max(worst, std::fabs(static_cast<double>(mapped_ns - true_ns)));
    }
  }
  return worst;
}

TEST(StampMapper, FollowsADriftingClock) {
  for (const double drift : {0.0, 50e-6, -50e-6}) {
    StampMapper mapper(kTransportNs);
    Device device{drift, -77 * hal::kNsPerSecond};
    const double worst_ns = WorstNs(mapper, device, 30 * 20, 30 * 600);
    std::cout << "drift " << 1e6 * drift << " ppm: " << 1e6 * -mapper.drift()
              << " ppm found, stamps off by at most " << 1e-3 * worst_ns << " us\n";
    EXPECT_NEAR(-mapper.drift(), drift, 2e-7);
    EXPECT_LT(worst_ns, 8e4);
    EXPECT_EQ(mapper.restarts(), 0U);
  }
}

TEST(StampMapper, WithoutJitterItIsExact) {
  StampMapper mapper(kTransportNs);
  const Device device{20e-6, 5 * hal::kNsPerSecond};
  std::int64_t worst_ns = 0;
  for (int k = 0; k < 1800; ++k) {
    const std::int64_t true_ns = k * kFrameNs;
    const std::int64_t mapped_ns = mapper.Map(device.Stamp(true_ns), true_ns + kTransportNs);
    worst_ns = k < 300 ? 0 : std::max<std::int64_t>(worst_ns, std::llabs(mapped_ns - true_ns));
  }
  EXPECT_LE(worst_ns, 2);  // rounding error
}

TEST(StampMapper, StampsRiseAndNeverComeAfterTheirArrival) {
  StampMapper mapper(0);
  std::mt19937_64 random(3);
  std::uniform_int_distribution<std::int64_t> late(0, 80 * hal::kNsPerMs);
  std::int64_t last_ns = INT64_MIN;
  std::int64_t arrival_ns = 0;
  for (int k = 0; k < 3000; ++k) {
    arrival_ns = std::max(arrival_ns + 1, k * kFrameNs + late(random));
    const std::int64_t mapped_ns = mapper.Map(k * kFrameNs, arrival_ns);
    ASSERT_GT(mapped_ns, last_ns);
    ASSERT_LE(mapped_ns, arrival_ns);
    last_ns = mapped_ns;
  }
}

// A camera repeats its last stamp, or gives one slightly earlier.
TEST(StampMapper, RepeatedOrEarlierStampIsMadeToRise) {
  StampMapper mapper(0);
  const std::int64_t first_ns = mapper.Map(10 * kFrameNs, 10 * kFrameNs);
  const std::int64_t again_ns = mapper.Map(10 * kFrameNs, 11 * kFrameNs);
  const std::int64_t before_ns = mapper.Map(10 * kFrameNs - hal::kNsPerMs, 12 * kFrameNs);
  EXPECT_EQ(again_ns, first_ns + 1);
  EXPECT_GT(before_ns, again_ns);
}

// An unplugged camera counts from zero again.
TEST(StampMapper, RestartedDeviceClockIsLearnedAgain) {
  StampMapper mapper(kTransportNs);
  Device device{0.0, 1000 * hal::kNsPerSecond};
  static_cast<void>(WorstNs(mapper, device, 0, 600));
  const std::int64_t again_ns = 100 * hal::kNsPerSecond;
  std::int64_t mapped_ns = 0;
  for (int k = 0; k < 3; ++k) {
    mapped_ns = mapper.Map(k * kFrameNs, again_ns + k * kFrameNs + kTransportNs);
    EXPECT_EQ(mapped_ns, again_ns + k * kFrameNs);
  }
  EXPECT_EQ(mapper.restarts(), 1U);
}

// A device clock stepped by less than a second. A forward step shows in the first picture, because a picture
// never arrives before its exposure; a backward step shows once all pictures of a second seem late.
TEST(StampMapper, SteppedDeviceClockIsLearnedAgain) {
  for (const std::int64_t step_ns : {150 * hal::kNsPerMs, -150 * hal::kNsPerMs, -30 * hal::kNsPerMs}) {
    StampMapper mapper(kTransportNs);
    Device device{20e-6, -77 * hal::kNsPerSecond};
    double worst_ns = 0.0;
    for (int k = 0; k < 30 * 60; ++k) {
      const std::int64_t true_ns = k * kFrameNs;
      device.offset_ns += k == 900 ? step_ns : 0;
      const std::int64_t mapped_ns = mapper.Map(device.Stamp(true_ns), device.Arrival(true_ns));
      const bool known = (k > 300 && k < 900) || k > (step_ns > 0 ? 960 : 960 + 32);
      worst_ns = std::max(worst_ns, known ? std::fabs(static_cast<double>(mapped_ns - true_ns)) : 0.0);
    }
    std::cout << "clock stepped by " << 1e-6 * static_cast<double>(step_ns) << " ms: off by at most "
              << 1e-3 * worst_ns << " us, except in the two seconds after\n";
    EXPECT_LT(worst_ns, 8e4);
    EXPECT_EQ(mapper.restarts(), 1U);
  }
}

// A busy network delays all pictures for most of a second.
TEST(StampMapper, BusyNetworkIsNotTakenForANewClock) {
  StampMapper mapper(kTransportNs);
  const Device device{0.0, 0};
  for (int k = 0; k < 30 * 60; ++k) {
    const std::int64_t true_ns = k * kFrameNs;
    const std::int64_t late_ns = k % 60 > 32 ? 60 * hal::kNsPerMs : 0;
    const std::int64_t mapped_ns = mapper.Map(device.Stamp(true_ns), true_ns + kTransportNs + late_ns);
    ASSERT_EQ(mapped_ns, true_ns) << k;
  }
  EXPECT_EQ(mapper.restarts(), 0U);
}

TEST(StampOfTicks, IsExactOrRefusedWhenOutOfRange) {
  EXPECT_EQ(StampOfTicks(123'456'789'012'345'678, 1.0), 123'456'789'012'345'678);
  EXPECT_EQ(StampOfTicks(10'000'000'000'000'001, 8.0), 80'000'000'000'000'008)
      << "125 MHz for two and a half years";
  EXPECT_EQ(StampOfTicks(3, 1.5), 5) << "4.5";
  EXPECT_EQ(StampOfTicks(-7, 8.0), -56);
  EXPECT_EQ(StampOfTicks(kMostStampNs, 1.0), kMostStampNs);
  EXPECT_FALSE(StampOfTicks(INT64_MAX, 1.0).has_value());
  EXPECT_FALSE(StampOfTicks(INT64_MAX, 1e9).has_value());
  EXPECT_FALSE(StampOfTicks(INT64_MIN, 8.0).has_value());
  EXPECT_FALSE(StampOfTicks(1, std::numeric_limits<double>::infinity()).has_value());
  EXPECT_FALSE(StampOfTicks(0, 1e300).has_value());
  EXPECT_FALSE(StampOfTicks(0, std::nan("")).has_value());
  EXPECT_FALSE(StampOfTicks(1, 0.0).has_value());
}

// For an impossible stamp the arrival time is used, and the mapping stays.
TEST(StampMapper, InvalidStampIsReplacedByTheArrival) {
  StampMapper mapper(kTransportNs);
  EXPECT_EQ(mapper.Map(kFrameNs, 2 * kFrameNs), 2 * kFrameNs - kTransportNs);
  std::int64_t arrival_ns = 2 * kFrameNs;
  for (const std::int64_t none_ns : {INT64_MAX, INT64_MIN, kMostStampNs + 1, -kMostStampNs - 1}) {
    arrival_ns += kFrameNs;
    EXPECT_EQ(mapper.Map(none_ns, arrival_ns), arrival_ns - kTransportNs) << none_ns;
  }
  EXPECT_EQ(mapper.restarts(), 0U);
  for (const std::int64_t far_ns : {kMostStampNs, -kMostStampNs, kMostStampNs}) {
    arrival_ns += kFrameNs;
    EXPECT_EQ(mapper.Map(far_ns, arrival_ns), arrival_ns - kTransportNs) << far_ns;
  }
  EXPECT_EQ(mapper.restarts(), 3U);
}

}  // namespace
}  // namespace fovea::camera
