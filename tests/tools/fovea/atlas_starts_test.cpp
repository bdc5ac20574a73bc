// SPDX-License-Identifier: Apache-2.0
// `fovea atlas --starts`: starts from a file, by posture or by camera pose, and its errors.
#include "tools/fovea/atlas/starts_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/tools/fovea/atlas_scene.hpp"

namespace fovea::atlas {
namespace {

using testing::HasSubstr;

class AtlasStartsFile : public testing::Test {
 protected:
  std::vector<Start> Read(const std::string& text) const {
    std::ofstream(file_) << text;
    return ReadStarts(file_, scene_);
  }
  void ExpectRefused(const std::string& text, const std::string& says) const {
    try {
      Read(text);
      ADD_FAILURE() << text;
    } catch (const config::InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("starts.csv"));
      EXPECT_THAT(error.what(), HasSubstr(says));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  [[nodiscard]] std::string Target() const {
    return fmt::format("{},{},{},{}", drawn_.p_BO.x(), drawn_.p_BO.y(), drawn_.p_BO.z(),
                       fmt::join(drawn_.rpy_deg, ","));
  }

  static constexpr const char* kPostureHeading =
      "q1,q2,q3,q4,q5,q6,q7,target_x,target_y,target_z,target_roll,target_pitch,target_yaw";

  const test::TempFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "starts.csv";
  const Scene scene_ = test::AtlasScene("panda", "square");
  const Sampler sampler_{scene_};
  const Start drawn_ = sampler_.Draw(1, 0);
};

TEST_F(AtlasStartsFile, PostureGoalAndSeedAreRead) {
  const std::string q = fmt::format("{}", fmt::join(drawn_.q, ","));
  const std::vector<Start> starts = Read(
      fmt::format("# of a published benchmark\n{0},seed,goal_x,goal_y,goal_z,goal_roll,goal_pitch,goal_yaw\n"
                  "{1},{2},77,0,0,0.5,0,0,90\n\n{1},{2},78,0,0,0.4,0,0,0\n",
                  kPostureHeading, q, Target()));
  ASSERT_EQ(starts.size(), 2U);
  EXPECT_EQ(starts[0].q, drawn_.q);
  EXPECT_EQ(starts[0].rpy_deg, drawn_.rpy_deg);
  EXPECT_EQ(starts[0].run_seed, 77U);
  EXPECT_EQ(starts[0].line, 3);
  EXPECT_EQ(starts[1].line, 5);
  ASSERT_TRUE(starts[0].goal);
  EXPECT_EQ(starts[0].goal->xyz[2], 0.5);
  EXPECT_EQ(starts[0].goal->rpy_deg[2], 90.0);
  EXPECT_NEAR(starts[1].error_px, drawn_.error_px, 1e-9) << "the scene's own goal";
  EXPECT_GT(std::fabs(starts[0].error_px - drawn_.error_px), 1.0) << "a goal of its own";
}

TEST_F(AtlasStartsFile, PostureIsFoundForACameraPose) {
  const model::VecN q = Eigen::Map<const model::VecN>(drawn_.q.data(), 7);
  const model::Pose X_BC = sampler_.goals().checks().At(q).X_BC;
  const std::array<double, 3> rpy = config::RollPitchYawOf(X_BC.R);
  const auto json_of = [&](double camera_x) {
    return fmt::format(R"([
  {{"camera_x": {}, "camera_y": {}, "camera_z": {}, "camera_roll": {}, "camera_pitch": {}, "camera_yaw": {},
    "target_x": {}, "target_y": {}, "target_z": {}, "target_roll": {}, "target_pitch": {}, "target_yaw": {}}}
])",
                       camera_x, X_BC.p.y(), X_BC.p.z(), rpy[0], rpy[1], rpy[2], drawn_.p_BO.x(),
                       drawn_.p_BO.y(), drawn_.p_BO.z(), drawn_.rpy_deg[0], drawn_.rpy_deg[1],
                       drawn_.rpy_deg[2]);
  };
  const std::vector<Start> starts = Read(json_of(X_BC.p.x()));
  ASSERT_EQ(starts.size(), 1U);
  EXPECT_EQ(starts[0].line, 2);
  const model::VecN found = Eigen::Map<const model::VecN>(starts[0].q.data(), 7);
  const model::Pose X_CC = X_BC.Inverse() * sampler_.goals().checks().At(found).X_BC;
  EXPECT_LT(X_CC.p.norm(), 1e-4);
  EXPECT_LT(model::RotationVector(X_CC.R).norm(), 1e-4);
  EXPECT_NEAR(starts[0].u_px, drawn_.u_px, 0.1);
  ExpectRefused(json_of(3.0), "no posture of the arm found that has the camera there");
}

TEST_F(AtlasStartsFile, ErrorsNameLineColumnAndWhatIsAllowed) {
  const std::string heading = fmt::format("{}\n", kPostureHeading);
  const std::string target = fmt::format(",{}\n", Target());
  ExpectRefused("", "contains no start");
  ExpectRefused(heading + "0,0,0,9,0,0,0" + target,
                "starts.csv:2: q4 = 9 is not allowed: -3.0718 to -0.0698 rad");
  ExpectRefused(heading + "0,0,0,nan,0,0,0" + target,
                "starts.csv:2: q4 = \"nan\" is not allowed: a finite number");
  ExpectRefused(heading + "0,0,0,inf,0,0,0" + target, "q4 = \"inf\" is not allowed");
  ExpectRefused(heading + "0,0,0,x,0,0,0" + target, "q4 = \"x\" is not allowed");
  ExpectRefused(heading + "0,0,0" + target, "starts.csv:2: 9 values for 13 columns");
  ExpectRefused(fmt::format("speed,{}{}{}", heading, "1,0,0,0,-2,0,1,0", target),
                "column speed is not allowed");
  ExpectRefused("q1,q2\n0,0\n",
                "column q3 is missing: allowed are all of q1, q2, q3, q4, q5, q6, q7 or none");
  ExpectRefused("seed\n0\n", "starts.csv:2: needs either q1 to q7 or camera_x to camera_yaw");
  ExpectRefused("q1,q2,q3,q4,q5,q6,q7\n0,0,0,-2,0,1,0\n", "column target_x is missing");
  ExpectRefused(fmt::format("seed,{}{}{}", heading, "0.5,0,0,0,-2,0,1,0", target),
                "seed = 0.5 is not allowed: a whole number");
  ExpectRefused(fmt::format("seed,{}{}{}", heading, "-1,0,0,0,-2,0,1,0", target),
                "seed = -1 is not allowed: 0 to ");
  ExpectRefused("[{\"q1\": \"a\"}]", "starts.csv:1: q1 = \"a\" is not allowed: a finite number");
  ExpectRefused("[{\"q1\": 0}", "not a JSON array of objects");
  ExpectRefused(heading + "0,0,0,-2,0,1,0,9,0,0,0,0,0\n", "target_x = 9 is not allowed: -5 to 5 m");
  ExpectRefused(heading + "0,0,0,-2,0,1,0,3,0,0.1,0,0,0\n", "no run can begin there: the target's outline");
}

}  // namespace
}  // namespace fovea::atlas
