// SPDX-License-Identifier: Apache-2.0
// Configuration values that are allowed alone but not together, and the choice of the camera driver.
#include "firmware/targets/linux/hw_config.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "firmware/host/config/input_error.hpp"
#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "fovea/camera/camera_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::hw {
namespace {

using config::InputError;
using testing::HasSubstr;

// The error line for `assignments` on top of configuration loopback; "" if they are accepted.
std::string RefusalOf(const std::vector<std::string>& assignments) {
  try {
    const HwConfig config = LoadHwConfig("loopback", assignments);
    const robots::Robot robot = LoadHwRobot(config);
    static_cast<void>(MakeHwServoConfig(config, robot));
    static_cast<void>(config::MakeVisionConfig(
        config.vision, config::MakeIntrinsics(config.camera.calibration), config.target));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(HwConfigTest, ContradictingValuesAreRefusedByName) {
  const struct {
    std::vector<std::string> assignments;
    const char* says;
  } kRows[]{
      {{"arm.model=slider"}, "arm.model = \"slider\" is not allowed: it has 1 joints"},
      {{"target.kind=circle", "servo.feature=corners"}, "is not allowed for target.kind = \"circle\""},
      {{"target.kind=square", "servo.feature=sphere"}, "servo.feature = \"sphere\" is not allowed"},
      {{"target.kind=square", "servo.law=pbvs", "servo.feature=corners"},
       "servo.law = \"pbvs\" is not allowed with servo.feature = \"corners\": allowed are \"auto\" and "
       "\"pose\""},
      {{"target.kind=square", "servo.law=mean", "servo.feature=hybrid"},
       "allowed are \"auto\" and a feature in the image"},
      {{"servo.goal=[0, 0, 0.03]"}, "the third number must be above its radius of 0.04 m"},
      {{"servo.stale_s=2", "servo.coast_s=1"}, "servo.stale_s = 2 is not allowed: at most servo.coast_s"},
      {{"safety.workspace_radius=0.5", "safety.workspace_margin=0.5"}, "below safety.workspace_radius"},
      {{"safety.workspace_margin=0"}, "safety.workspace_margin = 0 is not allowed"},
      {{"safety.view_margin_px=240"}, "it leaves nothing of a picture of 640 x 480 px"},
      {{"servo.posture=[0, 0]"}, "servo.posture has 2 entries, arm \"panda\" has 7 joints"},
      {{"safety.planes=[0, 0, 1, 0, 0]"}, "safety.planes has 5 entries: four for each plane"},
      {{"safety.planes=[0, 0, 0, 1]"}, "a plane's normal must not be zero"},
      {{"safety.boxes=[0, 0, 0, 1, 1, 1, 1]"}, "safety.boxes has 7 entries: six for each box"},
      {{"safety.boxes=[0, 0, 0, 1, 0, 1]"}, "each low corner must be below its high corner"},
      {{"target.kind=square", "vision.method=hough"}, "it finds only spheres and circles"},
      {{"vision.radius_min_px=50", "vision.radius_max_px=50"}, "must be below vision.radius_max_px"},
      {{"vision.distance_min=0.8", "vision.distance_max=0.8"}, "must be below vision.distance_max"},
  };
  for (const auto& row : kRows) {
    EXPECT_THAT(RefusalOf(row.assignments), HasSubstr(row.says)) << row.assignments.front();
  }
  EXPECT_EQ(RefusalOf({}), "");
}

// A silent robot is a fault after safety.arm_lost_ticks, and no single read may last longer.
TEST(HwConfigTest, ReadTimeoutBeyondTheLostLimitIsRefused) {
  EXPECT_THAT(
      RefusalOf({"robot.time=computer"}),
      HasSubstr(
          "robot.state_timeout_ms = 3000 is not allowed: at most safety.arm_lost_ticks, which is 20 ms"));
  EXPECT_EQ(RefusalOf({"robot.time=computer", "robot.state_timeout_ms=20"}), "");
  EXPECT_THAT(RefusalOf({"robot.time=computer", "robot.state_timeout_ms=20.5"}),
              HasSubstr("state_timeout_ms = 20.5"));
  EXPECT_EQ(RefusalOf({"robot.time=computer", "robot.state_timeout_ms=50", "safety.arm_lost_ticks=50"}), "");
  EXPECT_EQ(std::get<FciDriver::Settings>(LoadHwConfig("panda", {}).robot.of_driver).state_timeout_ms, 2.0);
}

TEST(HwConfigTest, DeadManIsOnByDefaultForARealRobot) {
  EXPECT_EQ(HwConfig().input.dead_man_s, 5.0);
  EXPECT_EQ(LoadHwConfig("panda", {}).input.dead_man_s, 5.0);
  EXPECT_EQ(LoadHwConfig("loopback", {}).input.dead_man_s, 0.0);
}

TEST(HwConfigTest, UnknownConfigurationListsTheShippedOnes) {
  try {
    static_cast<void>(LoadHwConfig("loop", {}));
    FAIL() << "there is no configuration of that name";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("unknown configuration \"loop\"; shipped are "));
    EXPECT_THAT(error.what(), HasSubstr("loopback"));
  }
  EXPECT_THROW(LoadHwConfig("no/such/file.toml", {}), InputError);
}

TEST(HwConfigTest, PlanesBoxesAndPostureReachTheServo) {
  const HwConfig config = LoadHwConfig(
      "loopback", {"safety.planes=[0, 0, 2, 0.5, 1, 0, 0, -0.3]", "safety.boxes=[-1, -1, 0, 0, 0, 0.4]",
                   "servo.posture=[0.1, 0.2, 0.3, -1.9, 0.5, 1.6, 0.7]", "arm.load_mass=0.5"});
  const robots::Robot robot = LoadHwRobot(config);
  const config::ServoConfig servo = MakeHwServoConfig(config, robot);
  const config::Obstacles& obstacles = servo.guard.obstacles;
  ASSERT_EQ(obstacles.num_planes, 2);
  ASSERT_EQ(obstacles.num_boxes, 1);
  EXPECT_EQ(obstacles.planes[0].normal, model::Vec3(0.0, 0.0, 1.0)) << "normalised";
  EXPECT_EQ(obstacles.planes[0].distance, 0.25);
  EXPECT_EQ(obstacles.planes[1].distance, -0.3);
  EXPECT_EQ(obstacles.boxes[0].high, model::Vec3(0.0, 0.0, 0.4));
  EXPECT_EQ(servo.law.q_posture[3], -1.9);
  EXPECT_EQ(
      FrankaConfigOf(LoadHwConfig("loopback", {"robot.set_load=true", "arm.load_mass=0.5"}), true).load.mass,
      0.5);
  EXPECT_EQ(FrankaConfigOf(config, true).load.mass, 0.0) << "robot.set_load is false there";
}

TEST(CameraDriverTest, OpensTheConfiguredDriverWithItsSettings) {
  const test::TempFolder temp;
  const auto open = [&temp](std::vector<std::string> assignments) {
    assignments.push_back("camera.device=" + (temp.path() / "eye").string());
    return OpenCamera(LoadHwConfig("loopback", assignments), 5'000'000'000);
  };
  EXPECT_THROW(open({"camera.driver=v4l2"}), camera::CameraError) << "no such device";
  EXPECT_THROW(open({"camera.driver=recorded"}), camera::CameraError) << "no such pictures";

  std::filesystem::create_directory(temp.path() / "eye");
  for (const char* name : {"1.png", "2.png"}) {
    cv::imwrite(temp.path() / "eye" / name, cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, 30)));
  }
  const std::unique_ptr<CameraDriver> eye =
      open({"camera.driver=recorded", "camera.rate_hz=50", "camera.exposure_ms=4"});
  EXPECT_THAT(eye->name(), HasSubstr("pictures from " + (temp.path() / "eye").string()));
  hal::Frame frame;
  ASSERT_TRUE(eye->camera().Acquire(frame, hal::kNsPerSecond).ok());
  EXPECT_EQ(frame.width_px, 64);
  EXPECT_EQ(frame.exposure_ns, 4 * hal::kNsPerMs);
  const std::int64_t first_ns = frame.stamp_ns;
  EXPECT_GE(first_ns, 5'000'000'000);
  ASSERT_TRUE(eye->camera().Acquire(frame, hal::kNsPerSecond).ok());
  EXPECT_EQ(frame.stamp_ns - first_ns, 20 * hal::kNsPerMs);
  const CameraCounters counters = eye->counters();
  EXPECT_EQ(counters.lost + counters.incomplete + counters.disconnects, 0U);
}

TEST(HwConfigTest, UnknownDriverIsRefusedWithTheAvailableOnes) {
  EXPECT_THAT(RefusalOf({"robot.driver=ur5"}), HasSubstr("expected one of, \"fci5\""));
  EXPECT_THAT(RefusalOf({"camera.driver=film"}),
              HasSubstr("expected one of, \"none\", \"genicam\", \"v4l2\", \"recorded\""));
}

}  // namespace
}  // namespace fovea::hw
