// SPDX-License-Identifier: Apache-2.0
// Maps a device clock to the host's clock from readings with a random round-trip delay.
#include "fovea/camera/latch_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>

#include "fovea/camera/stamp.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::camera {
namespace {

constexpr std::int64_t kBeginNs = 5'000'000'007;

// The device's clock has an offset and gains `drift` seconds per second on the host's. Question and answer
// each take 0.1 ms plus a random delay of 0.2 ms on average.
struct Device {
  double drift = 0.0;
  std::int64_t offset_ns = 0;
  std::mt19937_64 random{7};
  std::exponential_distribution<double> late_ms{1.0 / 0.2};

  [[nodiscard]] std::int64_t Stamp(std::int64_t host_ns) const {
    return offset_ns + host_ns + std::llround(drift * static_cast<double>(host_ns));
  }
  std::int64_t WayNs() { return 100'000 + static_cast<std::int64_t>(1e6 * late_ms(random)); }
  void Ask(LatchMapper& mapper, std::int64_t host_ns) {
    const std::int64_t before_ns = host_ns - WayNs();
    mapper.Add(before_ns, Stamp(host_ns), host_ns + WayNs());
  }
};

// Largest error [ns] of pictures' stamps from `from_s` to `to_s`, with four readings a second.
double WorstNs(LatchMapper& mapper, Device& device, int from_s, int to_s) {
  double worst = 0.0;
  for (int k = 0; k < 4 * to_s; ++k) {
    const std::int64_t now_ns = kBeginNs + k * hal::kNsPerSecond / 4;
    device.Ask(mapper, now_ns);
    const std::int64_t picture_ns = now_ns + 70 * hal::kNsPerMs;  // later than any reading
    if (k >= 4 * from_s) {
      worst =
          std::max(worst, std::fabs(static_cast<double>(*mapper.Map(device.Stamp(picture_ns)) - picture_ns)));
    }
  }
  return worst;
}

TEST(LatchMapper, FollowsADriftingClock) {
  for (const double drift : {0.0, 50e-6, -50e-6}) {
    LatchMapper mapper;
    Device device{drift, -77 * hal::kNsPerSecond};
    const double worst_ns = WorstNs(mapper, device, 20, 600);
    std::cout << "drift " << 1e6 * drift << " ppm: " << 1e6 * -mapper.drift()
              << " ppm found, stamps off by at most " << 1e-3 * worst_ns << " us\n";
    EXPECT_NEAR(-mapper.drift(), drift, 4e-6);
    EXPECT_LT(worst_ns, 6e4) << "less than the shortest one-way delay";
    EXPECT_EQ(mapper.restarts(), 0U);
  }
}

TEST(LatchMapper, WithoutJitterItIsExact) {
  LatchMapper mapper;
  const Device device{20e-6, 5 * hal::kNsPerSecond};
  std::int64_t worst_ns = 0;
  for (int k = 0; k < 400; ++k) {
    const std::int64_t now_ns = kBeginNs + k * hal::kNsPerSecond / 4;
    mapper.Add(now_ns - 150'000, device.Stamp(now_ns), now_ns + 150'000);
    worst_ns =
        k < 40 ? 0 : std::max<std::int64_t>(worst_ns, std::llabs(*mapper.Map(device.Stamp(now_ns)) - now_ns));
  }
  EXPECT_LE(worst_ns, 2);  // rounding error
}

TEST(LatchMapper, MapsAfterTheFirstReading) {
  LatchMapper mapper;
  EXPECT_FALSE(mapper.Map(0).has_value());
  mapper.Add(1000, 500'000, 3000);
  EXPECT_EQ(mapper.Map(500'000), 2000);
  EXPECT_EQ(mapper.Map(500'100), 2100);
}

// Fast readings at first, then only answers that are too slow. With 50 ppm of
// drift the mapping would be off by 3 ms after a minute.
TEST(LatchMapper, ClockNotReadForTooLongIsNotUsed) {
  LatchMapper mapper;
  const Device device{50e-6, -77 * hal::kNsPerSecond};
  std::int64_t now_ns = kBeginNs;
  const auto ask = [&](std::int64_t trip_ns) {
    mapper.Add(now_ns - trip_ns / 2, device.Stamp(now_ns), now_ns + trip_ns / 2);
  };
  for (int k = 0; k < 8; ++k) {
    now_ns += 20 * hal::kNsPerMs;
    ask(300'000);
  }
  const std::int64_t last_ns = now_ns;
  const auto after = [&](double s) { return mapper.Map(device.Stamp(last_ns + std::llround(1e9 * s))); };
  for (int k = 0; k < 240; ++k) {
    now_ns += hal::kNsPerSecond / 4;
    ask(6 * hal::kNsPerMs);
  }
  ASSERT_TRUE(after(1.9).has_value());
  EXPECT_NEAR(static_cast<double>(*after(1.9) - last_ns), 1.9e9, 1.2e5)
      << "error of 50 ppm, because the drift is not known yet";
  EXPECT_FALSE(after(2.1).has_value());
  EXPECT_FALSE(after(60.0).has_value());
  // A reading after such a gap is used alone, because the earlier ones are too old.
  ask(300'000);
  ASSERT_TRUE(mapper.Map(device.Stamp(now_ns)).has_value());
  EXPECT_NEAR(static_cast<double>(*mapper.Map(device.Stamp(now_ns)) - now_ns), 0.0, 1e3);
  EXPECT_EQ(mapper.restarts(), 0U);
}

TEST(LatchMapper, KnownDriftExtendsTheUsableTime) {
  LatchMapper mapper;
  Device device{50e-6, -77 * hal::kNsPerSecond};
  static_cast<void>(WorstNs(mapper, device, 0, 30));
  const std::int64_t last_ns = kBeginNs + 30 * hal::kNsPerSecond - hal::kNsPerSecond / 4;
  const auto after = [&](double s) { return mapper.Map(device.Stamp(last_ns + std::llround(1e9 * s))); };
  ASSERT_TRUE(after(9.9).has_value());
  std::cout << "9.9 s after the last reading a stamp is off by "
            << 1e-3 * (static_cast<double>(*after(9.9) - last_ns) - 9.9e9) << " us\n";
  EXPECT_NEAR(static_cast<double>(*after(9.9) - last_ns), 9.9e9, 1.4e5)
      << "drift error of 4 ppm, plus half a one-way delay";
  EXPECT_FALSE(after(10.1).has_value());
}

TEST(LatchMapper, SlowReadingIsIgnored) {
  LatchMapper mapper;
  mapper.Add(0, 1'000'000, 6 * hal::kNsPerMs);
  mapper.Add(10, 1'000'000, 5);
  EXPECT_FALSE(mapper.Map(0).has_value());
  EXPECT_EQ(mapper.readings(), 0U);
}

TEST(LatchMapper, RestartedDeviceClockIsLearnedAgain) {
  LatchMapper mapper;
  Device device{0.0, 1000 * hal::kNsPerSecond};
  static_cast<void>(WorstNs(mapper, device, 0, 20));
  const std::int64_t again_ns = kBeginNs + 100 * hal::kNsPerSecond;
  mapper.Add(again_ns - 1000, 0, again_ns + 1000);
  EXPECT_EQ(mapper.Map(0), again_ns);
  EXPECT_EQ(mapper.restarts(), 1U);
}

TEST(LatchMapper, SteppedDeviceClockIsLearnedAgain) {
  for (const std::int64_t step_ns : {150 * hal::kNsPerMs, -30 * hal::kNsPerMs}) {
    LatchMapper mapper;
    Device device{0.0, 1000 * hal::kNsPerSecond};
    static_cast<void>(WorstNs(mapper, device, 0, 20));
    const std::int64_t host_ns = kBeginNs + 20 * hal::kNsPerSecond;
    const std::int64_t device_ns = device.Stamp(host_ns) + step_ns;
    mapper.Add(host_ns - 1000, device_ns, host_ns + 1000);
    EXPECT_EQ(mapper.Map(device_ns), host_ns);
    EXPECT_EQ(mapper.restarts(), 1U);
  }
}

TEST(LatchMapper, InvalidStampIsIgnored) {
  LatchMapper mapper;
  for (const std::int64_t none_ns : {INT64_MAX, INT64_MIN, kMostStampNs + 1, -kMostStampNs - 1}) {
    mapper.Add(0, none_ns, 10);
    EXPECT_EQ(mapper.readings(), 0U) << none_ns;
  }
  mapper.Add(-5, kMostStampNs, 5);
  EXPECT_EQ(mapper.Map(kMostStampNs), 0);
  EXPECT_FALSE(mapper.Map(kMostStampNs + 1).has_value());
  EXPECT_FALSE(mapper.Map(INT64_MAX).has_value());
  EXPECT_FALSE(mapper.Map(INT64_MIN).has_value());
}

}  // namespace
}  // namespace fovea::camera
