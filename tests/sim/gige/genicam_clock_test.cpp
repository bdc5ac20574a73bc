// SPDX-License-Identifier: Apache-2.0
// The camera driver reads the camera's clock. Aravis' fake camera has the SFNC features for it.
#include <arv.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "fovea/genicam/genicam_camera.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {
namespace {

constexpr int kWidth = 64;  // one packet per picture
constexpr int kHeight = 48;
constexpr std::int64_t kTransportNs = 40 * hal::kNsPerMs;  // age of a picture's stamp when it is sent
constexpr std::int64_t kPatience = 20 * hal::kNsPerSecond;

// The camera's clock has an offset and a drift.
constexpr double kGains = 200e-6;
std::int64_t DeviceNs(std::int64_t host_ns) {
  return host_ns - 1000 + std::llround(kGains * static_cast<double>(host_ns));
}

// Features for the camera's description file; the registers are GigE Vision's.
constexpr const char* kSfnc1 = R"(
  <Command Name="GevTimestampControlLatch"><pValue>LatchRegister</pValue><CommandValue>2</CommandValue></Command>
  <Integer Name="GevTimestampValue"><pValue>LatchedRegister</pValue></Integer>)";
constexpr const char* kSfnc2 = R"(
  <Command Name="TimestampLatch"><pValue>LatchRegister</pValue><CommandValue>2</CommandValue></Command>
  <Integer Name="TimestampLatchValue"><pValue>LatchedRegister</pValue></Integer>)";
constexpr const char* kRegisters = R"(
  <IntReg Name="LatchRegister"><Address>0x944</Address><Length>4</Length><AccessMode>RW</AccessMode>
    <pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>
  <IntReg Name="LatchedRegister"><Address>0x948</Address><Length>8</Length><AccessMode>RO</AccessMode>
    <pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>)";

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};

// A camera on this computer's network. Its latched time is refreshed with each picture, 500 times per second.
class ClockedCamera {
 public:
  ClockedCamera(const std::string& features, bool another_clock) : another_clock_(another_clock) {
    GBytes* bytes =
        g_resources_lookup_data("/org/aravis/arv-fake-camera.xml", G_RESOURCE_LOOKUP_FLAGS_NONE, nullptr);
    gsize size = 0;
    const auto* text = static_cast<const char*>(g_bytes_get_data(bytes, &size));
    std::string xml(text, size);
    g_bytes_unref(bytes);
    xml.insert(xml.rfind("</RegisterDescription>"), features + kRegisters);
    const std::string path = (folder_.path() / "camera.xml").string();
    std::ofstream(path) << xml;
    camera_.reset(arv_gv_fake_camera_new_full("127.0.0.1", "clocked", path.c_str()));
    registers_ = arv_gv_fake_camera_get_fake_camera(camera_.get());
    arv_fake_camera_write_register(registers_, ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, 2000);
    arv_fake_camera_set_fill_pattern(
        registers_,
        [](ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
          static_cast<ClockedCamera*>(self)->Fill(buffer);
        },
        this);
  }
  [[nodiscard]] bool running() const { return arv_gv_fake_camera_is_running(camera_.get()) != FALSE; }

 private:
  void Fill(ArvBuffer* buffer) {
    const std::int64_t now_ns = linux_rt::MonotonicNs();
    arv_buffer_set_timestamp(buffer, static_cast<guint64>(DeviceNs(now_ns - kTransportNs)));
    const auto latched =
        static_cast<std::uint64_t>(DeviceNs(now_ns) + (another_clock_ ? 5 * hal::kNsPerSecond : 0));
    arv_fake_camera_write_register(registers_, 0x948, static_cast<guint32>(latched >> 32U));
    arv_fake_camera_write_register(registers_, 0x94C, static_cast<guint32>(latched));
  }

  const bool another_clock_;
  TempFolder folder_;
  std::unique_ptr<ArvGvFakeCamera, Unref> camera_;
  ArvFakeCamera* registers_ = nullptr;
};

struct Outcome {
  std::vector<double> off_ms;  // stamp errors of the later frames, sorted
  genicam::GenicamCounters counters;
};

// Runs the driver on such a camera for `frames` pictures.
Outcome TakePictures(const std::string& features, bool another_clock = false, int frames = 400) {
  const ClockedCamera camera(features, another_clock);
  EXPECT_TRUE(camera.running());
  genicam::GenicamConfig config;
  config.device = "127.0.0.1";
  config.width_px = kWidth;
  config.height_px = kHeight;
  config.packet_size = 16000;
  config.stamp_at = genicam::StampAt::kMiddle;
  // transport_ns stays 0: the driver needs it only if it cannot read the camera's clock.
  genicam::GenicamCamera driver(config);
  Outcome outcome;
  std::int64_t last_ns = INT64_MIN;
  for (int k = 0; k < frames; ++k) {
    hal::Frame frame;
    if (!driver.Acquire(frame, kPatience).ok()) {
      ADD_FAILURE() << "no picture";
      break;
    }
    EXPECT_GT(frame.stamp_ns, last_ns);
    last_ns = frame.stamp_ns;
    if (k > frames / 2) {
      outcome.off_ms.push_back(1e-6 *
                               static_cast<double>(linux_rt::MonotonicNs() - kTransportNs - frame.stamp_ns));
    }
  }
  std::sort(outcome.off_ms.begin(), outcome.off_ms.end());
  outcome.counters = driver.counters();
  return outcome;
}

// The stamp error of the frame that was taken soonest [ms]; on a busy machine other frames wait longer.
double Soonest(const Outcome& outcome) { return outcome.off_ms.at(0); }

TEST(GenicamClock, ReadableCameraClockNeedsNoTransportTime) {
  for (const char* features : {kSfnc1, kSfnc2}) {
    const Outcome outcome = TakePictures(features);
    std::cout << "stamps are off by " << Soonest(outcome) << " ms, the transport time is 40 ms; "
              << outcome.counters.stamped_by_clock << " of " << outcome.counters.frames << " by its clock\n";
    EXPECT_GT(outcome.counters.stamped_by_clock, outcome.counters.frames / 2);
    EXPECT_LT(outcome.counters.clock_refused, outcome.counters.frames / 20)
        << "the clock reads 0 before the first picture";
    EXPECT_LT(std::fabs(Soonest(outcome)), 5.0) << "1.5 times the possible error of a reading";
  }
}

TEST(GenicamClock, WithoutTheLatchFeatureStampsComeFromArrivals) {
  const Outcome outcome = TakePictures("");
  std::cout << "stamps are off by " << Soonest(outcome) << " ms\n";
  EXPECT_EQ(outcome.counters.stamped_by_clock, 0U);
  EXPECT_LT(Soonest(outcome), -35.0) << "the transport time is not configured";
}

TEST(GenicamClock, ClockOtherThanThePicturesIsNotUsed) {
  const Outcome outcome = TakePictures(kSfnc2, /*another_clock=*/true);
  EXPECT_EQ(outcome.counters.stamped_by_clock, 0U);
  EXPECT_GT(outcome.counters.clock_refused, 0U);
  EXPECT_LT(Soonest(outcome), -35.0) << "stamps come from the arrivals again";
}

}  // namespace
}  // namespace fovea::test
