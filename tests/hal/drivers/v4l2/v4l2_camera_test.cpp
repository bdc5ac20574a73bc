// SPDX-License-Identifier: Apache-2.0
// The driver with a scripted device. Not tried on hardware.
#include "fovea/v4l2/v4l2_camera.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "fovea/camera/camera_error.hpp"
#include "tests/contract/camera_contract.hpp"
#include "tests/hal/drivers/v4l2/scripted_device.hpp"

namespace fovea::test {
namespace {

v4l2::V4l2Config Config() {
  v4l2::V4l2Config config;
  config.path = "/dev/video7";
  config.exposure_us = 4000.0;
  return config;
}

struct V4l2Fixture {
  ScriptedCamera device;
  v4l2::V4l2Camera driver{Config(), std::make_unique<ScriptedDevice>(device)};
  std::uint32_t next = 0;
  hal::Camera& camera() { return driver; }
  void Expose(std::int64_t stamp_ns) {
    // Stamped at the end of an exposure of 4 ms.
    device.Expose(
        {.gray = static_cast<std::uint8_t>(next), .stamp_us = stamp_ns / 1000 + 2000, .sequence = next});
    ++next;
  }
  void Close() { driver.Close(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(V4l2, CameraContract, V4l2Fixture);

std::string ErrorOf(ScriptedCamera& device, const v4l2::V4l2Config& config = Config()) {
  try {
    v4l2::V4l2Camera camera(config, std::make_unique<ScriptedDevice>(device));
    return "";
  } catch (const camera::CameraError& error) {
    EXPECT_EQ(device.mapped, 0) << "all buffers are unmapped";
    return error.what();
  }
}

TEST(V4l2Camera, AppliesTheConfiguredSettings) {
  ScriptedCamera device;
  v4l2::V4l2Config config = Config();
  config.gain = 12;
  config.rate_hz = 60.0;
  {
    const v4l2::V4l2Camera camera(config, std::make_unique<ScriptedDevice>(device));
    EXPECT_EQ(camera.name(), "Scripted");
    EXPECT_EQ(device.controls[V4L2_CID_EXPOSURE_AUTO], V4L2_EXPOSURE_MANUAL);
    EXPECT_EQ(device.controls[V4L2_CID_EXPOSURE_ABSOLUTE], 40) << "in units of 100 us";
    EXPECT_EQ(device.controls[V4L2_CID_GAIN], 12);
    EXPECT_EQ(device.mapped, 4);
    EXPECT_TRUE(device.streaming);
  }
  EXPECT_EQ(device.mapped, 0);
  EXPECT_FALSE(device.streaming);
}

TEST(V4l2Camera, StampsAreMidExposureWhereverTheKernelTakesThem) {
  struct Case {
    std::uint32_t flags;
    std::int64_t expected_ns;
  };
  constexpr std::int64_t kStampUs = 5'000'000;
  for (const Case& c : {Case{V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE, 5'002'000'000},
                        {V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF, 4'991'000'000}}) {
    ScriptedCamera device;
    device.stamp_flags = c.flags;
    v4l2::V4l2Config config = Config();
    config.transport_ns = 7 * hal::kNsPerMs;
    v4l2::V4l2Camera camera(config, std::make_unique<ScriptedDevice>(device));
    device.Expose({.stamp_us = kStampUs});
    hal::Frame frame;
    ASSERT_TRUE(camera.Acquire(frame, 0).ok());
    EXPECT_EQ(frame.stamp_ns, c.expected_ns);
    EXPECT_EQ(frame.exposure_ns, 4 * hal::kNsPerMs);
  }
}

TEST(V4l2Camera, FormatsAreConvertedForTheSeam) {
  for (const auto& [name, fourcc, format] : {std::tuple{"Mono8", V4L2_PIX_FMT_GREY, hal::PixelFormat::kMono8},
                                             {"BayerRG8", V4L2_PIX_FMT_SRGGB8, hal::PixelFormat::kBgr8},
                                             {"YUYV", V4L2_PIX_FMT_YUYV, hal::PixelFormat::kBgr8},
                                             {"BGR8", V4L2_PIX_FMT_BGR24, hal::PixelFormat::kBgr8}}) {
    ScriptedCamera device;
    device.formats = {V4L2_PIX_FMT_MJPEG, static_cast<std::uint32_t>(fourcc)};
    v4l2::V4l2Config config = Config();
    config.pixel_format = name;
    v4l2::V4l2Camera camera(config, std::make_unique<ScriptedDevice>(device));
    device.Expose({.gray = 128});
    hal::Frame frame;
    ASSERT_TRUE(camera.Acquire(frame, 0).ok()) << name;
    EXPECT_EQ(frame.format, format) << name;
    EXPECT_EQ(frame.width_px, 640);
    EXPECT_NEAR(frame.pixels[frame.pixels.size() / 2], 128, 3) << name;
  }
}

TEST(V4l2Camera, TakesTheNewestCompletePicture) {
  ScriptedCamera device;
  v4l2::V4l2Camera camera(Config(), std::make_unique<ScriptedDevice>(device));
  device.Expose({.gray = 1, .sequence = 0});
  device.Expose({.gray = 2, .sequence = 1});
  device.Expose({.gray = 3, .sequence = 2, .flags = V4L2_BUF_FLAG_ERROR});
  device.Expose({.gray = 4, .sequence = 3, .missing_bytes = 100});
  hal::Frame frame;
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  EXPECT_EQ(frame.pixels[0], 2);
  EXPECT_EQ(camera.counters().overtaken, 1U);
  EXPECT_EQ(camera.counters().incomplete, 2U);
  device.Expose({.gray = 5, .sequence = 7});
  const std::uint64_t before = frame.sequence;
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  EXPECT_EQ(frame.sequence, before + 6) << "a gap is a lost frame";
  EXPECT_EQ(camera.counters().lost, 5U);
}

TEST(V4l2Camera, PictureTakenBeforeTheUnplugKeepsItsExposure) {
  ScriptedCamera device;
  v4l2::V4l2Camera camera(Config(), std::make_unique<ScriptedDevice>(device));
  device.Expose({.gray = 1, .stamp_us = 6000});
  device.unplug_when_empty = true;
  hal::Frame frame;
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  EXPECT_EQ(frame.exposure_ns, 4 * hal::kNsPerMs);
  EXPECT_EQ(frame.stamp_ns, 4 * hal::kNsPerMs);
  EXPECT_EQ(camera.counters().disconnects, 1U);
}

TEST(V4l2Camera, ReconnectsAfterBeingUnplugged) {
  ScriptedCamera device;
  v4l2::V4l2Camera camera(Config(), std::make_unique<ScriptedDevice>(device));
  device.Expose({.gray = 1, .sequence = 41});
  hal::Frame frame;
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  const std::uint64_t before = frame.sequence;
  device.plugged = false;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(camera.Acquire(frame, hal::kNsPerMs).code(), hal::StatusCode::kTimeout);
  }
  EXPECT_EQ(camera.counters().disconnects, 1U);
  device.plugged = true;
  EXPECT_EQ(camera.Acquire(frame, hal::kNsPerSecond).code(), hal::StatusCode::kTimeout)
      << "the camera is back, without a picture yet";
  EXPECT_EQ(camera.counters().reconnects, 1U);
  device.Expose({.gray = 9, .sequence = 0});
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  EXPECT_EQ(frame.pixels[0], 9);
  EXPECT_EQ(frame.sequence, before + 1) << "the count continues";

  v4l2::V4l2Config once = Config();
  once.reconnect = false;
  v4l2::V4l2Camera lost(once, std::make_unique<ScriptedDevice>(device));
  device.plugged = false;
  EXPECT_EQ(lost.Acquire(frame, 0).code(), hal::StatusCode::kDisconnected);
  EXPECT_EQ(lost.Acquire(frame, 0).code(), hal::StatusCode::kDisconnected);
}

TEST(V4l2Camera, ImpossibleConfigurationIsRefusedWithAReason) {
  const auto refusal = [](void (*spoil)(ScriptedCamera&, v4l2::V4l2Config&)) {
    ScriptedCamera device;
    v4l2::V4l2Config config = Config();
    spoil(device, config);
    return ErrorOf(device, config);
  };
  using Device = ScriptedCamera&;
  using Asked = v4l2::V4l2Config&;
  EXPECT_EQ(refusal([](Device d, Asked) { d.plugged = false; }),
            "camera /dev/video7: cannot be opened: No such file or directory");
  EXPECT_EQ(refusal([](Device d, Asked) { d.takes_pictures = false; }),
            "camera /dev/video7: it does not capture video, or does not stream it");
  EXPECT_EQ(refusal([](Device, Asked c) { c.width_px = 1280; }),
            "camera /dev/video7: its pictures are 640 x 480 px, not 1280 x 480");
  EXPECT_EQ(refusal([](Device, Asked c) { c.pixel_format = "BGR8"; }),
            "camera /dev/video7: gives GREY pictures, not BGR3");
  EXPECT_EQ(refusal([](Device, Asked c) { c.pixel_format = "Mono12"; }),
            "camera /dev/video7: pixel format Mono12 is not one of Mono8, Bayer..8, YUYV, RGB8, BGR8");
  EXPECT_EQ(refusal([](Device d, Asked) { d.formats = {V4L2_PIX_FMT_MJPEG}; }),
            "camera /dev/video7: pixel format MJPG is not one of Mono8, Bayer..8, YUYV, RGB8, BGR8");
  EXPECT_EQ(refusal([](Device, Asked c) { c.rate_hz = 500.0; }),
            "camera /dev/video7: it changed the frame rate from 500.000000 to 120.000000 Hz");
  EXPECT_EQ(refusal([](Device d, Asked) { d.refused_controls = {V4L2_CID_EXPOSURE_ABSOLUTE}; }),
            "camera /dev/video7: refuses exposure time = 40: Invalid argument");
  EXPECT_EQ(refusal([](Device d, Asked) { d.busy = true; }),
            "camera /dev/video7: gives no buffers; is another program using it?: Device or resource busy");
}

TEST(V4l2Camera, MissingDeviceThrowsCameraError) {
  for (const char* path : {"/dev/no-such-video", "/dev/null"}) {
    v4l2::V4l2Config config;
    config.path = path;
    EXPECT_THROW(v4l2::V4l2Camera camera(config), camera::CameraError) << path;
  }
}

}  // namespace
}  // namespace fovea::test
