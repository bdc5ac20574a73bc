// SPDX-License-Identifier: Apache-2.0
// A scenario's keys, without the command line.
#include "sim/scenario/scenario.hpp"

#include <gtest/gtest.h>

#include <set>

#include "firmware/host/config/input_error.hpp"
#include "fovea/hal/events.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {
namespace {

// Why the scenario `ball` is refused with these assignments; "" if it is not.
std::string RefusalOf(const std::vector<std::string>& assignments) {
  try {
    DescribeRun(LoadScenario("ball", assignments));
  } catch (const config::InputError& error) {
    return error.what();
  }
  return "";
}

// A key that a fault or limit refers to must exist.
TEST(ScenarioTest, EveryKeyThatAFaultOrLimitNamesExists) {
  Scenario scenario;
  const config::KeyTable table = ScenarioKeys(scenario);
  std::set<std::string> keys{""};
  for (const config::Key& key : table.keys()) {
    EXPECT_TRUE(keys.insert(key.name).second) << key.name << " exists twice";
  }
  for (int i = 0; i < hal::kNumFaults; ++i) {
    EXPECT_EQ(keys.count(hal::Key(static_cast<hal::Fault>(i))), 1U) << hal::Key(static_cast<hal::Fault>(i));
  }
  for (int i = 0; i < hal::kNumLimits; ++i) {
    EXPECT_EQ(keys.count(hal::Key(static_cast<hal::Limit>(i))), 1U) << hal::Key(static_cast<hal::Limit>(i));
  }
}

TEST(ScenarioTest, EveryRenamedKeyHasASuccessorAndIsNoKeyItself) {
  Scenario scenario;
  const config::KeyTable table = ScenarioKeys(scenario);
  std::set<std::string> keys;
  for (const config::Key& key : table.keys()) {
    keys.insert(key.name);
  }
  EXPECT_FALSE(table.successors().empty());
  for (const auto& [former, today] : table.successors()) {
    EXPECT_EQ(keys.count(former), 0U) << former;
    EXPECT_EQ(keys.count(today), 1U) << today;
  }
}

TEST(ScenarioTest, RealismFillsInWhatIsNotGiven) {
  const auto arm = [](const std::vector<std::string>& assignments) {
    return LoadScenario("ball", assignments).arm;
  };
  EXPECT_TRUE(arm({}).rotor_inertia.empty());
  EXPECT_EQ(arm({}).drives.torque_delay_ms, 0.0);
  const auto panda = arm({"arm.realism=panda"});
  EXPECT_EQ(panda.rotor_inertia.size(), 7U);
  EXPECT_GT(panda.drives.torque_bandwidth_hz, 0.0);
  EXPECT_GT(panda.drives.torque_delay_ms, 0.0);
  EXPECT_GT(panda.drives.velocity_filter_hz, 0.0);
  EXPECT_GT(panda.encoder_quantum, 0.0);
  const auto own = arm({"arm.torque_delay_ms=0", "arm.encoder_quantum=0", "arm.realism=panda"});
  EXPECT_EQ(own.drives.torque_delay_ms, 0.0);
  EXPECT_EQ(own.encoder_quantum, 0.0);
  EXPECT_EQ(own.drives.torque_bandwidth_hz, panda.drives.torque_bandwidth_hz);
}

TEST(ScenarioTest, ServoAndPhysicsHaveTheRotors) {
  const RunDescription run = DescribeRun(LoadScenario("ball", {"arm.realism=panda"}));
  for (const SimLink& link : run.scene.robot.links) {
    if (link.dof >= 0) {
      EXPECT_EQ(link.rotor_inertia, run.scenario.arm.rotor_inertia.at(static_cast<std::size_t>(link.dof)));
      EXPECT_EQ(link.rotor_inertia,
                run.servo.arm.joints.at(static_cast<std::size_t>(link.dof)).rotor_inertia);
    }
  }
}

TEST(ScenarioTest, DrivesThatCannotBeAreRefused) {
  EXPECT_EQ(
      RefusalOf({"arm.realism=ur"}),
      "arm.realism = \"ur\" is not allowed with arm \"panda\": it is for a Universal Robot (a name that "
      "begins with \"ur\" and a digit)");
  // A Puma has six joints, too.
  const std::vector<std::string> puma{"arm.model=puma560", "arm.q_start=[0,0.5,0,0,0.5,0]", "arm.realism=ur"};
  EXPECT_NE(RefusalOf(puma).find("\"ur\" is not allowed with arm \"puma560\""), std::string::npos);
  EXPECT_NE(RefusalOf({"arm.model=ur5e", "arm.q_start=[0,0,0,0,0,0]", "arm.realism=panda"})
                .find("\"panda\" is not allowed with arm \"ur5e\": it is for a Panda"),
            std::string::npos);
  EXPECT_EQ(RefusalOf({"arm.torque_ripple=[1, 2]"}), "arm.torque_ripple has 2 entries: 1 or 7 are allowed");
  EXPECT_EQ(RefusalOf({"arm.rotor_inertia=[0.1]"}),
            "arm.rotor_inertia has 1 entries, arm \"panda\" has 7 joints");
  EXPECT_NE(RefusalOf({"arm.rotor_inertia=[-0.1]"}).find("arm.rotor_inertia"), std::string::npos);
  EXPECT_NE(RefusalOf({"arm.torque_delay_ms=51"}).find("arm.torque_delay_ms"), std::string::npos);
  EXPECT_NE(RefusalOf({"truth.arm.rotor_inertia.offset=-0.1"}).find("truth.arm.rotor_inertia"),
            std::string::npos);
}

TEST(ScenarioTest, ElasticJointsThatCannotBeAreRefused) {
  const auto message = [](std::vector<std::string> assignments) -> std::string {
    assignments.insert(assignments.begin(), "arm.realism=panda");
    try {
      DescribeRun(LoadScenario("ball", assignments));
    } catch (const config::InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto refuses = [&message](const std::vector<std::string>& assignments, const std::string& says) {
    EXPECT_NE(message(assignments).find(says), std::string::npos) << message(assignments);
  };
  EXPECT_EQ(message({"arm.joint_stiffness=14000", "arm.joint_damping=20", "arm.encoder_side=link"}), "");
  EXPECT_EQ(message({"arm.joint_stiffness=0"}), "");
  refuses({"arm.joint_stiffness=[1000, 2000]"}, "arm.joint_stiffness has 2 entries: 1 or 7 are allowed");
  refuses({"arm.joint_stiffness=-1"}, "arm.joint_stiffness");
  refuses({"arm.joint_stiffness=99"}, "a joint has at least 100 Nm/rad, or all have 0");
  refuses({"arm.joint_stiffness=[0,1e4,1e4,1e4,1e4,1e4,1e4]"}, "or all have 0");
  refuses({"arm.joint_damping=1"}, "arm.joint_damping is not allowed without arm.joint_stiffness");
  refuses({"arm.joint_stiffness=1e4", "arm.rotor_inertia=[1,1,1,1,1,1,0]"}, "joint 7 has no rotor");
  refuses({"arm.joint_stiffness=1e4", "truth.arm.rotor_inertia=[1,1,1,1,1,1,0]"}, "joint 7 has no rotor");
  refuses({"arm.joint_stiffness=1e4", "arm.integrator=rk4"}, "arm.integrator = \"rk4\" is not allowed");
  refuses({"arm.encoder_side=gear"}, "arm.encoder_side");
}

TEST(ScenarioTest, BoxesThatCannotBeAreRefused) {
  EXPECT_EQ(RefusalOf({"bench.boxes=[0.6,0.3,0,0.7,0.4,0.2]"}), "");
  EXPECT_EQ(RefusalOf({"bench.boxes=[0.6,0.3,0,0.7,0.4]"}),
            "bench.boxes has 5 entries: six for each box are allowed");
  EXPECT_EQ(RefusalOf({"bench.boxes=[0.6,0.3,0,0.5,0.4,0.2]"}),
            "bench.boxes: box 1: each low corner must be below its high corner");
  EXPECT_NE(RefusalOf({"bench.boxes=[0.6,0.3,0,0.7,0.4,0.2, -0.1,-0.1,0.2,0.1,0.1,0.5]"})
                .find("inside box 2 of bench.boxes"),
            std::string::npos);
  EXPECT_NE(RefusalOf({"bench.boxes=[0.6,0.3,0,0.7,0.4,0.2]", "target.motion=pushed"}).find("pushed ball"),
            std::string::npos);
  EXPECT_NE(RefusalOf({"bench.boxes=[0.6,0.3,0,0.7,0.4,0.2, 0.4,-0.1,0,0.7,0.3,0.2]"})
                .find("target.position is not allowed: it is in box 2 of bench.boxes"),
            std::string::npos);
  EXPECT_NE(RefusalOf({"safety.boxes=[0.6,0.3,0,0.7,0.4,0.2, -0.1,-0.1,0.2,0.1,0.1,0.5]"})
                .find("inside box 2 of safety.boxes"),
            std::string::npos);
}

TEST(ScenarioTest, HueFollowsTheTargetsColourUnlessItIsSet) {
  const auto hue = [](const std::vector<std::string>& assignments) {
    return LoadScenario("ball", assignments).vision.config.colour.hue_deg;
  };
  EXPECT_EQ(hue({}), 0.0);
  EXPECT_NEAR(hue({"target.colour=[0.1, 0.1, 0.8]"}), 240.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.1, 0.8, 0.1]"}), 120.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.8, 0.45, 0.1]"}), 30.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.8, 0.1, 0.45]"}), 330.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.1, 0.1, 0.8]", "vision.hue_deg=30"}), 30.0, 1e-9);
  EXPECT_EQ(hue({"target.colour=[0.5, 0.5, 0.5]"}), 0.0) << "gray has no hue";
}

TEST(ScenarioTest, IntrinsicsAreTakenWholeOrRefused) {
  const auto pinhole = [](const std::vector<std::string>& assignments) {
    return MakeScenarioPinhole(LoadScenario("ball", assignments));
  };
  EXPECT_TRUE(pinhole({}).IsPlain());
  const std::vector<std::string> all{"camera.f_u_px=571.3", "camera.f_v_px=566.9", "camera.c_u_px=301.7",
                                     "camera.c_v_px=252.2"};
  const Pinhole own = pinhole(all);
  EXPECT_FALSE(own.IsPlain());
  EXPECT_EQ(own.f_px, 571.3);
  EXPECT_DOUBLE_EQ(own.FocalV(), 566.9);
  EXPECT_EQ(own.c_v_px, 252.2);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<std::string> some = all;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_THROW(pinhole(some), config::InputError) << "without " << all[i];
  }
  std::vector<std::string> outside = all;
  outside.emplace_back("camera.c_u_px=640");
  EXPECT_THROW(pinhole(outside), config::InputError);
}

TEST(ScenarioTest, StartFasterThanALimitIsRefused) {
  const auto describe = [](const std::string& dq) {
    DescribeRun(LoadScenario("ball", {"arm.dq_start=" + dq}));
  };
  EXPECT_NO_THROW(describe("[0.1, 0.1, 0, 0, 0, 0, 0]"));
  EXPECT_THROW(describe("[2, 2, 2, 2, 2, 2, 2]"), config::InputError) << "a joint is too fast";
  EXPECT_THROW(describe("[0, 0, 0, 0, 2, 0, 2]"), config::InputError) << "the hand is too fast";
}

TEST(ScenarioTest, MoreFrictionCompensationThanFrictionIsRefused) {
  const auto describe = [](const std::vector<std::string>& keys) { DescribeRun(LoadScenario("ball", keys)); };
  EXPECT_NO_THROW(describe({"servo.friction_compensation=0.1", "arm.friction_compensation=0.9"}));
  EXPECT_THROW(describe({"servo.friction_compensation=0.2", "arm.friction_compensation=0.9"}),
               config::InputError);
}

// A law brings its feature with it; without a law, the feature has one.
TEST(ScenarioTest, LawAndFeatureFitTogether) {
  using config::Law;
  using features::FeatureForm;
  const struct {
    const char* scenario;
    std::vector<std::string> assignments;
    Law law;
    FeatureForm form;
  } kRows[]{{"square", {}, Law::kIbvs, FeatureForm::kCorners},
            {"triangle", {}, Law::kPbvs, FeatureForm::kPose},
            {"ball", {}, Law::kIbvs, FeatureForm::kSphere},
            {"square", {"servo.law=pbvs"}, Law::kPbvs, FeatureForm::kPose},
            {"square", {"servo.feature=pose"}, Law::kPbvs, FeatureForm::kPose},
            {"square", {"servo.law=hybrid"}, Law::kHybrid, FeatureForm::kHybrid},
            {"square", {"servo.law=mean", "servo.feature=side"}, Law::kMean, FeatureForm::kSide},
            {"triangle", {"servo.law=second_order"}, Law::kSecondOrder, FeatureForm::kCorners},
            {"ball", {"servo.law=pbvs"}, Law::kPbvs, FeatureForm::kPose},
            {"circle", {"servo.law=desired"}, Law::kDesired, FeatureForm::kCircle},
            {"triangle", {"servo.law=predictive"}, Law::kPredictive, FeatureForm::kCorners}};
  for (const auto& row : kRows) {
    const config::ServoConfig servo = DescribeRun(LoadScenario(row.scenario, row.assignments)).servo;
    EXPECT_EQ(servo.law.law, row.law) << row.scenario;
    EXPECT_EQ(servo.feature.form, row.form) << row.scenario;
  }
}

// A horizon leads to a pose.
TEST(ScenarioTest, PredictiveLawNeedsAGoalForTheWholePose) {
  const auto describe = [](const char* scenario, const std::vector<std::string>& keys) {
    DescribeRun(LoadScenario(scenario, keys));
  };
  EXPECT_NO_THROW(describe("square", {"servo.law=predictive"}));
  EXPECT_NO_THROW(describe("ball", {"servo.law=predictive"}));
  EXPECT_THROW(describe("square", {"servo.law=predictive", "servo.feature=side"}), config::InputError);
  EXPECT_THROW(describe("square", {"servo.law=predictive", "servo.feature=pose"}), config::InputError);
  EXPECT_THROW(describe("ball", {"servo.law=predictive", "servo.hold_orientation=true"}), config::InputError);
}

TEST(ScenarioTest, OnlyARunWithAStillTargetEndsEarly) {
  EXPECT_NO_THROW(DescribeRun(LoadScenario("ball", {"run.settled_s=1"})));
  EXPECT_THROW(DescribeRun(LoadScenario("ball-moving", {"run.settled_s=1"})), config::InputError);
  EXPECT_THROW(DescribeRun(LoadScenario("ball-exciting", {"run.settled_s=1"})), config::InputError);
}

}  // namespace
}  // namespace fovea::sim
