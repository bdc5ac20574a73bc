// SPDX-License-Identifier: Apache-2.0
// The camera driver with the simulated camera, over this computer's network.
#include "sim/gige/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "fovea/camera/camera_error.hpp"
#include "fovea/genicam/genicam_camera.hpp"
#include "sim/camera/sim_camera.hpp"
#include "tests/contract/camera_contract.hpp"

namespace fovea::test {
namespace {

constexpr int kWidth = 64;  // one packet per picture: it is not lost on a busy machine
constexpr int kHeight = 48;
constexpr std::int64_t kPatience = 20 * hal::kNsPerSecond;

// Blue, green or red of the picture number `sequence`.
std::uint8_t ColourOf(std::uint64_t sequence, std::size_t channel) {
  return static_cast<std::uint8_t>(40 + 30 * channel + 5 * sequence);
}

sim::Painter NumberPainter() {
  return {[](const sim::Exposure& exposure, std::span<std::uint8_t> rgba) {
            for (std::size_t i = 0; i < rgba.size(); i += 4) {
              for (std::size_t c = 0; c < 3; ++c) {
                rgba[i + c] = ColourOf(exposure.sequence, 2 - c);
              }
            }
          },
          {}};
}

genicam::GenicamConfig Client() {
  genicam::GenicamConfig config;
  config.device = "127.0.0.1";
  config.width_px = kWidth;
  config.height_px = kHeight;
  config.packet_size = 16000;
  config.device_time = true;
  config.stamp_at = genicam::StampAt::kMiddle;
  return config;
}

// A simulated camera whose colours encode the picture number, on the network, and the driver.
struct Bench {
  explicit Bench(const genicam::GenicamConfig& client = Client(), std::int64_t transport_ns = 0) {
    Plug(transport_ns);
    driver = std::make_unique<genicam::GenicamCamera>(client);
  }
  void Plug(std::int64_t transport_ns = 0) {
    server = std::make_unique<sim::GigeCamera>(
        eye, sim::GigeCameraConfig{
                 .serial = "test", .width_px = kWidth, .height_px = kHeight, .transport_ns = transport_ns});
  }
  void Expose(std::int64_t stamp_ns) {
    for (int i = 0; i < 1000 && !server->streaming(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    sim::Exposure exposure;
    exposure.stamp_ns = stamp_ns;
    exposure.sequence = next++;
    EXPECT_TRUE(server->Expect(stamp_ns));
    eye.Expose(exposure);
    server->Advance(stamp_ns, /*wait=*/false);
  }
  hal::Frame Take() {
    hal::Frame frame;
    EXPECT_TRUE(driver->Acquire(frame, kPatience).ok());
    return frame;
  }

  sim::SimCamera eye{{.width_px = kWidth, .height_px = kHeight, .exposure_ns = 1000, .queue = 16},
                     sim::Sensor({.read_sigma = 0.0}, 1),
                     {NumberPainter()}};
  std::uint64_t next = 0;
  std::unique_ptr<sim::GigeCamera> server;
  std::unique_ptr<genicam::GenicamCamera> driver;
};

struct GenicamFixture : Bench {
  hal::Camera& camera() { return *driver; }
  void Close() {
    server->Advance(INT64_MAX / 2, /*wait=*/true);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // sent pictures arrive
    driver->Close();
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Genicam, CameraContract, GenicamFixture);

TEST(GigeCamera, FramesMatchThePicturesOfTheEye) {
  Bench bench;
  EXPECT_EQ(bench.driver->width_px(), kWidth);
  EXPECT_NE(bench.driver->name().find("test"), std::string::npos);
  std::uint64_t last = 0;
  for (int k = 0; k < 8; ++k) {
    bench.Expose(hal::kNsPerSecond + k * 33 * hal::kNsPerMs);
    const hal::Frame frame = bench.Take();
    EXPECT_EQ(frame.stamp_ns, hal::kNsPerSecond + k * 33 * hal::kNsPerMs);
    EXPECT_EQ(frame.exposure_ns, 5 * hal::kNsPerMs) << "the camera's own exposure time";
    EXPECT_TRUE(k == 0 || frame.sequence == last + 1);
    last = frame.sequence;
    ASSERT_EQ(frame.format, hal::PixelFormat::kBgr8);
    for (const std::size_t at :
         {std::size_t{0}, frame.pixels.size() / 2 - frame.pixels.size() / 2 % 3, frame.pixels.size() - 3}) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(frame.pixels[at + c], ColourOf(static_cast<std::uint64_t>(k), c));
      }
    }
  }
  hal::Frame frame;
  frame.sequence = 77;
  EXPECT_EQ(bench.driver->Acquire(frame, 10 * hal::kNsPerMs).code(), hal::StatusCode::kTimeout)
      << "a repeated picture is not a new one";
  EXPECT_EQ(frame.sequence, 77U);
}

TEST(GigeCamera, AllFormatsShowTheSamePicture) {
  for (const char* format : {"Mono8", "BayerRG8", "BayerGR8", "BayerGB8", "BayerBG8", "RGB8"}) {
    genicam::GenicamConfig client = Client();
    client.pixel_format = format;
    Bench bench(client);
    bench.Expose(hal::kNsPerSecond);
    const hal::Frame frame = bench.Take();
    const std::size_t middle = frame.pixels.size() / 2 - frame.pixels.size() / 2 % 3;
    if (frame.format == hal::PixelFormat::kMono8) {
      EXPECT_NEAR(frame.pixels[middle],
                  0.114 * ColourOf(0, 0) + 0.587 * ColourOf(0, 1) + 0.299 * ColourOf(0, 2), 1.0);
    } else {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(frame.pixels[middle + c], ColourOf(0, c)) << format;
      }
    }
  }
}

TEST(GigeCamera, PictureIsSentAfterItsTransportTime) {
  Bench bench(Client(), 40 * hal::kNsPerMs);
  bench.Expose(hal::kNsPerSecond);
  hal::Frame frame;
  EXPECT_EQ(bench.driver->Acquire(frame, 50 * hal::kNsPerMs).code(), hal::StatusCode::kTimeout);
  bench.server->Advance(hal::kNsPerSecond + 39 * hal::kNsPerMs, false);
  EXPECT_EQ(bench.driver->Acquire(frame, 50 * hal::kNsPerMs).code(), hal::StatusCode::kTimeout);
  bench.server->Advance(hal::kNsPerSecond + 40 * hal::kNsPerMs, true);
  EXPECT_EQ(bench.server->sent(), 1U) << "Advance waits until the picture is sent";
  EXPECT_EQ(bench.Take().stamp_ns, hal::kNsPerSecond);
}

TEST(GigeCamera, TakesTheNewestOfSeveral) {
  Bench bench;
  for (int k = 0; k < 4; ++k) {
    bench.Expose((k + 1) * hal::kNsPerMs);
    bench.server->Advance((k + 1) * hal::kNsPerMs, true);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  while (bench.Take().stamp_ns != 4 * hal::kNsPerMs && !HasFailure()) {
  }
  const genicam::GenicamCounters counters = bench.driver->counters();
  EXPECT_EQ(counters.frames + counters.overtaken, 4U);
  EXPECT_GE(counters.overtaken, 1U);
}

TEST(GigeCamera, UnpluggedCameraTimesOutUntilItIsBack) {
  Bench bench;
  bench.Expose(hal::kNsPerSecond);
  const std::uint64_t before = bench.Take().sequence;
  bench.server.reset();
  hal::Frame frame;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (bench.driver->counters().disconnects == 0 && std::chrono::steady_clock::now() < end) {
    EXPECT_EQ(bench.driver->Acquire(frame, 100 * hal::kNsPerMs).code(), hal::StatusCode::kTimeout);
  }
  ASSERT_EQ(bench.driver->counters().disconnects, 1U);
  bench.Plug();
  bench.Expose(2 * hal::kNsPerSecond);
  const hal::Frame after = bench.Take();
  EXPECT_EQ(after.stamp_ns, 2 * hal::kNsPerSecond);
  EXPECT_GT(after.sequence, before);
  EXPECT_EQ(bench.driver->counters().reconnects, 1U);
}

TEST(GigeCamera, WithoutReconnectionALossIsReported) {
  genicam::GenicamConfig client = Client();
  client.reconnect = false;
  Bench bench(client);
  bench.server.reset();
  hal::Frame frame;
  hal::StatusCode code = hal::StatusCode::kTimeout;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (code == hal::StatusCode::kTimeout && std::chrono::steady_clock::now() < end) {
    code = bench.driver->Acquire(frame, 100 * hal::kNsPerMs).code();
  }
  EXPECT_EQ(code, hal::StatusCode::kDisconnected);
}

std::string ErrorOf(const genicam::GenicamConfig& config) {
  try {
    genicam::GenicamCamera camera(config);
    return "";
  } catch (const camera::CameraError& error) {
    return error.what();
  }
}

TEST(GigeCamera, AppliesTheConfiguredSettings) {
  genicam::GenicamConfig client = Client();
  client.device = "";  // the first camera that answers
  client.pixel_format = "";
  client.rate_hz = 25.0;
  client.exposure_us = 8000.0;
  client.gain = 3.0;
  client.packet_size = 0;  // chosen by the network
  for (const auto& [at, to_middle_ms] : {std::pair{genicam::StampAt::kStart, 4},
                                         {genicam::StampAt::kMiddle, 0},
                                         {genicam::StampAt::kEnd, -4}}) {
    client.stamp_at = at;
    Bench bench(client);
    bench.Expose(hal::kNsPerSecond);
    const hal::Frame frame = bench.Take();
    EXPECT_EQ(frame.exposure_ns, 8 * hal::kNsPerMs);
    EXPECT_EQ(frame.stamp_ns, hal::kNsPerSecond + to_middle_ms * hal::kNsPerMs);
  }
}

TEST(GigeCamera, ImpossibleConfigurationIsRefusedWithAReason) {
  genicam::GenicamConfig client = Client();
  EXPECT_NE(ErrorOf(client).find("camera 127.0.0.1: not found"), std::string::npos) << ErrorOf(client);
  Bench bench;
  bench.driver.reset();
  client.pixel_format = "Mono16";
  EXPECT_NE(ErrorOf(client).find("not one of Mono8"), std::string::npos) << ErrorOf(client);
  client.pixel_format = "Mono9";
  EXPECT_NE(ErrorOf(client).find("pixel format Mono9"), std::string::npos) << ErrorOf(client);
  client = Client();
  client.width_px = 100'000;
  EXPECT_NE(ErrorOf(client).find("camera 127.0.0.1: "), std::string::npos) << ErrorOf(client);
  EXPECT_THROW(sim::GigeCamera(bench.eye, {.serial = "second"}), std::runtime_error) << "the port is taken";
  EXPECT_THROW(sim::GigeCamera(bench.eye, {.serial = "far more than fifteen"}), std::runtime_error);
}

}  // namespace
}  // namespace fovea::test
