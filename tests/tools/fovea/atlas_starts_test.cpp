// SPDX-License-Identifier: Apache-2.0
// `fovea atlas --starts`: starts from a file, by posture or by camera pose, and its errors.
#include "tools/fovea/atlas/starts_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/tools/fovea/atlas_scene.hpp"
#include "tools/fovea/atlas/views.hpp"

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
    ExpectRefused(text, says, scene_);
  }
  void ExpectRefused(const std::string& text, const std::string& says, const Scene& scene) const {
    std::ofstream(file_) << text;
    try {
      static_cast<void>(ReadStarts(file_, scene));
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

// The simulator would refuse each of these goals, once its run begins.
TEST_F(AtlasStartsFile, GoalsThatTheSimulatorRefusesAreFoundBeforeAnyRun) {
  const std::string heading =
      fmt::format("{},goal_x,goal_y,goal_z,goal_roll,goal_pitch,goal_yaw\n", kPostureHeading);
  const std::string start = fmt::format("{},{}", fmt::join(drawn_.q, ","), Target());
  const std::string text = heading + start + ",0,0,0.5,0,0,0\n" + start;
  EXPECT_EQ(Read(text + ",0,0,0.4,0,0,0\n").size(), 2U);
  ExpectRefused(text + ",0,0,-0.4,0,0,0\n",
                "starts.csv:3: goal_z = -0.4 is not allowed: the target must be wholly in front");
  ExpectRefused(text + ",0,0,0,0,0,0\n", "starts.csv:3: goal_z = 0 is not allowed");
  ExpectRefused(text + ",0,0,0.04,0,0,0\n", "starts.csv:3: goal_z = 0.04 is not allowed");
  ExpectRefused(text + ",1,0,0.4,0,0,0\n", "starts.csv:3: goal_x = 1 is not allowed with goal_z = 0.4");
  ExpectRefused(text + ",0,-0.3,0.4,0,0,0\n", "starts.csv:3: goal_y = -0.3 is not allowed with goal_z = 0.4");
}

TEST_F(AtlasStartsFile, GoalsOutOfTheDetectorsReachAreRefused) {
  Scene scene = scene_;
  scene.reach = {0.12, 1.2};
  const std::string text =
      fmt::format("{},goal_x,goal_y,goal_z,goal_roll,goal_pitch,goal_yaw\n{},{},0,0,{{}},0,0,0\n",
                  kPostureHeading, fmt::join(drawn_.q, ","), Target());
  for (const double z : {0.1, 4.9}) {
    ExpectRefused(fmt::format(fmt::runtime(text), z),
                  fmt::format("starts.csv:2: goal_z = {0} is not allowed: the goal's distance is {0} m; "
                              "vision.distance_min and vision.distance_max allow 0.12 to 1.2 m",
                              z),
                  scene);
  }
}

TEST_F(AtlasStartsFile, MarksAndLineEndsOfAnySystemAreRead) {
  const std::string start = fmt::format("{},{}", fmt::join(drawn_.q, ","), Target());
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::vector<Start> starts = Read("\xEF\xBB\xBF" + (kPostureHeading + end) + end + start);
    ASSERT_EQ(starts.size(), 1U);
    EXPECT_EQ(starts[0].q, drawn_.q);
    EXPECT_EQ(starts[0].line, 3);
    ExpectRefused("\xEF\xBB\xBF[" + end + "{" + end + "\"q1\":" + end + "true}]", "starts.csv:3: q1 = true");
  }
}

TEST_F(AtlasStartsFile, CsvErrorsNameThePlaceAndQuoteLittle) {
  ExpectRefused("# only\n\nq1,q2\n", "starts.csv:3: contains no start: this heading needs a line of values");
  ExpectRefused("\nq1,q2,q1\n", "starts.csv:2: column q1 occurs twice");
  ExpectRefused("q1,,q2\n", "starts.csv:1: column 2 of the heading has no name");
  ExpectRefused("\xFF\xFEq\x01", "is UTF-16: UTF-8 is allowed");
  const std::string nines(5000, '9');
  for (const std::string& text :
       {"q1\n" + nines + "\n", nines + "\nx\n", nines + "\n0\n", "[{\"q1\":\"" + nines + "\"}]",
        "[{\"q1\":" + nines + "}]", "[{\"" + nines + "\":null}]", "[{\"" + nines + "\":1}]",
        "[" + nines + "]", "[{}" + nines + "]"}) {
    try {
      Read(text);
      ADD_FAILURE() << text.substr(0, 9);
    } catch (const config::InputError& error) {
      EXPECT_LT(std::string(error.what()).size(), file_.string().size() + 250U) << error.what();
    }
  }
}

TEST_F(AtlasStartsFile, JsonErrorsNameThePlace) {
  ExpectRefused("[{\"q1\":1},\n{\"q1\":\n NaN}]", "starts.csv:2: q1 = NaN is not allowed: a finite number");
  ExpectRefused("[{\n\"q1\": 1e400}]", "starts.csv:2: q1 = 1e400 is not allowed: a finite number");
  ExpectRefused("[{\n\n\"q1\": -Infinity}]", "starts.csv:3: q1 = -Infinity is not allowed");
  ExpectRefused("[{\"q1\": }]", "starts.csv:1: q1 = } is not allowed: a finite number");
  ExpectRefused("[{\"q1\": 0,\n\"q1\": 1}]", "starts.csv:2: column q1 occurs twice");
  ExpectRefused("[\n {\"q1\": 0.0.1}]", "starts.csv:2: character 9, \"0.0.1\": not a JSON array of objects");
  ExpectRefused("[{\"q1\" 0}]", "starts.csv:1: character 8, \"0\": not a JSON array");
  ExpectRefused("[{\"q1\": 0}\n]]", "starts.csv:2: character 2, \"]\": not a JSON array");
  ExpectRefused("[{\"q1\": 0\n", "starts.csv:2: character 1, the end: not a JSON array");
  ExpectRefused("{\"q1\": 0}", "starts.csv:1: {...}: not a JSON array");
  ExpectRefused("[{},\n7]", "starts.csv:2: 7: not a JSON array");
  ExpectRefused("[]", "contains no start");
  // A backslash at a text's end once hid where the text ends.
  ExpectRefused("[{\"a\\\\\":1},\n{\"q1\":1},\n{\"q1\":\"x\"}]", "starts.csv:3: q1 = \"x\" is not allowed");
}

TEST_F(AtlasStartsFile, DeepJsonIsRefusedWhereItGetsTooDeep) {
  const std::string deep(300000, '[');
  const std::string end(300000, ']');
  ExpectRefused("[{\"q1\":" + deep + end + "}]", "starts.csv:1: q1 = [...] is not allowed");
  ExpectRefused(deep + end, "starts.csv:1: [...]: not a JSON array of objects");
  std::string nested = "[";
  for (int i = 0; i < 100000; ++i) {
    nested += "{\"q1\":";
  }
  ExpectRefused(nested, "starts.csv:1: q1 = {...} is not allowed");
}

// A pipe that nobody writes to would be waited for, and a large file fill the memory.
TEST_F(AtlasStartsFile, OnlyRegularFilesOfSomeSizeAreRead) {
  const auto expect_refused = [&](const std::filesystem::path& file, const std::string& says) {
    for (const bool hash : {false, true}) {
      try {
        hash ? static_cast<void>(HashOfFile(file)) : static_cast<void>(ReadStarts(file, scene_));
        ADD_FAILURE() << file;
      } catch (const config::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("--starts " + file.string() + ": " + says));
      }
    }
  };
  const std::filesystem::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::filesystem::path& file : {pipe, std::filesystem::path("/dev/zero"), folder_.path()}) {
    expect_refused(file, "is not a regular file: a CSV or JSON file is allowed");
  }
  expect_refused(folder_.path() / "none", "cannot be read");
  std::ofstream(file_) << "q1\n";
  std::filesystem::resize_file(file_, 101'000'000);  // a hole, which takes no room
  expect_refused(file_, "101 MB are not allowed: at most 100 MB");
}

TEST_F(AtlasStartsFile, TargetOutOfTheDetectorsReachIsRefused) {
  const std::string text = fmt::format("{}\n{},{}\n", kPostureHeading, fmt::join(drawn_.q, ","), Target());
  std::ofstream(file_) << text;
  const double distance =
      std::hypot(drawn_.depth * scene_.camera.Ray(drawn_.u_px, drawn_.v_px).x(),
                 drawn_.depth * scene_.camera.Ray(drawn_.u_px, drawn_.v_px).y(), drawn_.depth);
  for (const double off : {-1e-3, 1e-3}) {
    Scene scene = scene_;
    scene.reach =
        off < 0.0 ? planning::EyeReach{0.1, distance + off} : planning::EyeReach{distance + off, 9.0};
    try {
      static_cast<void>(ReadStarts(file_, scene));
      ADD_FAILURE() << off;
    } catch (const config::InputError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("starts.csv:2: no run can begin there: the target is nearer to the camera "
                            "than vision.distance_min, or farther than vision.distance_max"));
    }
  }
}

// Turns, shifts and distances are those of the benchmark, as far as the poses of the file say. Each line can
// be run.
TEST(AtlasViews, PairsHaveTheBenchmarksRangesAndCanBeRead) {
  Scene scene = test::AtlasScene("gantry", "triangle");
  scene.servo.guard.workspace_radius = 2.5;
  scene.reach.farthest = 1.2;
  // So large that it does not fit into the picture everywhere.
  for (model::Vec3& corner : scene.servo.feature.corners.corners) {
    corner *= 4.0;
  }
  constexpr int kPairs = 40;
  std::vector<double> turns;
  double worst = 0.0;
  for (int i = 0; i < kPairs; ++i) {
    const ViewPair pair = DrawViewPair(scene, 7, i);
    const model::Pose X_CO{config::RollPitchYaw(pair.goal.rpy_deg),
                           {pair.goal.xyz[0], pair.goal.xyz[1], pair.goal.xyz[2]}};
    const model::Pose X_SG = pair.X_BC.Inverse() * (pair.X_BO * X_CO.Inverse());  // goal in the start's axes
    const double turn = model::RotationVector(X_SG.R).norm();
    worst = std::max({worst, std::fabs(turn - pair.turn), std::fabs(X_SG.p.norm() - pair.shift)});
    turns.push_back(turn * 180.0 / model::kPi);
    EXPECT_TRUE(turns.back() > 2.6 && turns.back() < 180.1) << turns.back();
    EXPECT_TRUE(pair.shift >= 0.013 && pair.shift <= 0.493);
    EXPECT_TRUE(pair.goal.xyz[2] >= 0.5 && pair.goal.xyz[2] <= 0.9);
    EXPECT_LE((pair.X_BC.Inverse() * pair.X_BO).p.norm(), 1.2);
    EXPECT_TRUE(StartChecks(scene).InPicture(X_CO)) << "the goal";
  }
  std::sort(turns.begin(), turns.end());
  std::cout << "turns from " << turns.front() << " to " << turns.back() << " deg, median "
            << turns[kPairs / 2] << "; poses in the file are off by at most " << worst << "\n";
  EXPECT_LT(worst, 2e-4);
  EXPECT_LT(turns.front(), 20.0);
  EXPECT_GT(turns.back(), 150.0);
  const test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "views.csv";
  const std::string text = ViewsAsCsv(scene, 7, 5);
  EXPECT_EQ(text, ViewsAsCsv(scene, 7, 5));
  std::ofstream(file) << text;
  const std::vector<Start> starts = ReadStarts(file, scene);
  ASSERT_EQ(starts.size(), 5U);
  for (int i = 0; i < 5; ++i) {
    const Start& start = starts[static_cast<std::size_t>(i)];
    const ViewPair pair = DrawViewPair(scene, 7, i);
    const StartChecks checks(scene);
    const model::Pose X_BC = checks.At(Eigen::Map<const model::VecN>(start.q.data(), 6)).X_BC;
    EXPECT_LT((X_BC.p - pair.X_BC.p).norm(), 1e-4);
    EXPECT_EQ(start.goal->xyz.size(), 3U);
    EXPECT_EQ(start.run_seed, static_cast<std::uint32_t>(i + 1));
  }
}

// No point of the arm's links or of a line of sight is near a box, by sampling both.
TEST(AtlasBoxes, StartsAreClearOfBoxes) {
  Scene scene = test::AtlasScene("panda", "square");
  scene.boxes = {{{0.30, 0.30, 0.0}, {0.42, 0.42, 0.35}}, {{0.25, -0.45, 0.0}, {0.45, -0.33, 0.30}}};
  config::Obstacles& known = scene.servo.guard.obstacles;
  known.num_boxes = 1;  // the servo knows a third
  known.boxes[0] = {{0.60, -0.06, 0.0}, {0.72, 0.06, 0.20}};
  std::vector<config::Box> boxes = scene.boxes;
  boxes.push_back(known.boxes[0]);
  const auto distance = [&](const model::Vec3& p) {
    double least = HUGE_VAL;
    for (const config::Box& box : boxes) {
      least = std::min(least, (p - p.cwiseMax(box.low).cwiseMin(box.high)).norm());
    }
    return least;
  };
  const Sampler sampler(scene);
  double links = HUGE_VAL;
  double sight = HUGE_VAL;
  double target = HUGE_VAL;
  std::uint64_t in_the_way = 0;
  for (int index = 0; index < 30; ++index) {
    const Start start = sampler.Draw(3, index);
    in_the_way += start.rejections[static_cast<std::size_t>(Rejection::kThingInTheWay)];
    const StartPosture posture =
        sampler.goals().checks().At(Eigen::Map<const model::VecN>(start.q.data(), 7));
    constexpr int kPoints = 200;
    for (int k = 0; k <= kPoints; ++k) {
      const double share = k / double{kPoints};
      for (auto body = posture.bodies.begin() + 1; body != posture.bodies.end(); ++body) {
        links = std::min(links, distance(body->p_LA + share * (body->p_LB - body->p_LA)) - body->radius);
      }
      const features::TargetOutline outline = scene.servo.feature.Outline();
      for (int i = 0; i < outline.num_points; ++i) {
        const model::Vec3 p_BP = start.TargetPose() * outline.p_OP[static_cast<std::size_t>(i)];
        target = std::min(target, distance(p_BP));
        sight = std::min(sight, distance(posture.X_BC.p + 0.9 * share * (p_BP - posture.X_BC.p)));
      }
    }
  }
  std::cout << "30 starts: links " << links << ", lines of sight " << sight << ", corners " << target
            << " m from a box; " << in_the_way << " draws rejected for a box or thing in the way\n";
  EXPECT_GE(links, 0.03);
  EXPECT_GE(sight, 0.0299);
  EXPECT_GE(target, 0.0299);
  EXPECT_GT(in_the_way, 0U);
}

}  // namespace
}  // namespace fovea::atlas
