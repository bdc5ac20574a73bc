// SPDX-License-Identifier: Apache-2.0
// The verdict, on synthetic runs that keep or break each bound.
#include "sim/verdict/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/panda.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kGoalZ = 0.4;

class VerdictTest : public testing::Test {
 protected:
  VerdictTest() {
    config_.barriers.arm = test::Panda().model;
    config_.stop.ddq_max.setOnes(7);
    config_.stop.dddq_max.setOnes(7);
    config_.goal.p_CO_C_star = {0.0, 0.0, kGoalZ};
    config_.tracking_bound_px = 3.0;
  }

  // A run of `duration_s` in which the target is off its goal by `offset(t)`, in axes of C [m].
  Summary Judge(double duration_s, const std::function<Eigen::Vector3d(double)>& offset,
                const std::function<void(Truth&)>& change = {}) {
    config_.duration_s = duration_s;
    Verdict verdict(config_);
    const auto ticks = static_cast<std::int64_t>(duration_s * 1e3);
    for (std::int64_t k = 0; k <= ticks; ++k) {
      Truth truth;
      truth.stamp_ns = k * kMs;
      truth.q = test::Ready();
      truth.dq = truth.tau_cmd = Eigen::VectorXd::Zero(7);
      truth.X_BE.translation() = Eigen::Vector3d(0.3, 0.0, 0.5);
      truth.p_BO = config_.goal.p_CO_C_star + offset(static_cast<double>(k) * 1e-3);  // C is B here
      if (change) {
        change(truth);
      }
      verdict.AddTruth(truth, hal::Mode::kTrack);
    }
    for (const hal::TickRecord& record : records_) {
      verdict.AddRecord(record);
    }
    Summary summary;
    summary.frames = frames_;
    summary.frames_lost = frames_lost_;
    summary.frames_detected = frames_detected_;
    verdict.Fill(summary);
    return summary;
  }
  static Eigen::Vector3d Still(double) { return {0.0005, 0.0, 0.0}; }

  VerdictConfig config_;
  std::vector<hal::TickRecord> records_;
  std::uint64_t frames_ = 1;
  std::uint64_t frames_lost_ = 0;
  std::uint64_t frames_detected_ = 1;
};

TEST_F(VerdictTest, FiguresAreOfTheLastHalfSecond) {
  const Summary s = Judge(2.0, [](double t) {
    return t < 1.5 ? Eigen::Vector3d(0.1, 0.0, 0.0) : Eigen::Vector3d(0.0003, 0.0004, 0.0012);
  });
  EXPECT_TRUE(s.converged);
  EXPECT_NEAR(*s.start_error_px, config_.eye.pinhole.f_px * 0.1 / 0.4, 1e-9);
  EXPECT_NEAR(*s.final_error_px_rms, config_.eye.pinhole.f_px * 0.0005 / 0.4012, 1e-9);
  EXPECT_NEAR(*s.final_error_lateral_mm, 0.5, 1e-9);
  EXPECT_NEAR(*s.final_error_depth_mm, 1.2, 1e-9);
  EXPECT_NEAR(*s.final_error_mm, 1.3, 1e-9);
  EXPECT_EQ(s.tracking_error_px_rms, std::nullopt);
}

TEST_F(VerdictTest, OneSampleTooFarOffInTheWindowIsNotConverged) {
  const auto pixel_off = [&](double t) {
    return Eigen::Vector3d(std::abs(t - 1.7) < 1e-6 ? 1.01 * kGoalZ / config_.eye.pinhole.f_px : 0.0, 0.0,
                           0.0);
  };
  EXPECT_FALSE(Judge(2.0, pixel_off).converged);
  const auto depth_off = [](double t) {
    return Eigen::Vector3d(0.0, 0.0, std::abs(t - 1.7) < 1e-6 ? 0.00201 : 0.0);
  };
  const Summary s = Judge(2.0, depth_off);
  EXPECT_FALSE(s.converged);
  EXPECT_THAT(s.verdict, testing::HasSubstr("not converged"));
}

// A camera that is longer than the servo believes sees the goal's picture from further away. At the goal in
// metres a ball on the axis has its centre at the right pixel, but not its size.
TEST_F(VerdictTest, LongerCameraIsJudgedWhereItsPictureIsTheGoals) {
  config_.eye.believed_pinhole = config_.eye.pinhole;
  config_.eye.pinhole.f_px *= 1.05;
  config_.eye.differs = true;
  const Summary further = Judge(2.0, [](double) { return Eigen::Vector3d(0.0, 0.0, 0.05 * kGoalZ); });
  EXPECT_TRUE(further.converged);
  EXPECT_NEAR(*further.final_error_mm, 50.0 * kGoalZ, 1e-9) << "to the goal in metres";
  EXPECT_FALSE(Judge(2.0, [](double) { return Eigen::Vector3d(0.0, 0.0, 0.0); }).converged);
}

TEST_F(VerdictTest, SettleTimeIsThatOfTheLastReturn) {
  const Summary s = Judge(4.0, [](double t) {
    const bool peak = t > 2.4 && t < 2.6;
    return Eigen::Vector3d(peak ? 0.01 : 0.1 * std::exp(-4.0 * t), 0.0, 0.0);
  });
  EXPECT_NEAR(*s.settle_time_s, 2.6, 1.5e-3);
  EXPECT_EQ(Judge(1.0, [](double) { return Eigen::Vector3d(0.1, 0.0, 0.0); }).settle_time_s, std::nullopt);
}

TEST_F(VerdictTest, TargetBehindTheCameraHasNoPixelError) {
  const Summary s = Judge(1.0, [](double) { return Eigen::Vector3d(0.0, 0.0, -0.8); });
  EXPECT_FALSE(s.converged);
  EXPECT_EQ(s.final_error_px_rms, std::nullopt);
}

TEST_F(VerdictTest, MovingTargetIsJudgedOverTheSecondHalf) {
  config_.target_moves = true;
  const double px = kGoalZ / config_.eye.pinhole.f_px;
  EXPECT_TRUE(
      Judge(2.0, [&](double t) { return Eigen::Vector3d((t < 0.99 ? 50 : 2.9) * px, 0, 0); }).converged);
  const Summary s = Judge(2.0, [&](double) { return Eigen::Vector3d(3.1 * px, 0, 0); });
  EXPECT_FALSE(s.converged);
  EXPECT_NEAR(*s.tracking_error_px_rms, 3.1, 1e-9);
}

// The pixel error says nothing about the distance to the target.
TEST_F(VerdictTest, MovingTargetIsJudgedInDepthToo) {
  config_.target_moves = true;
  config_.tracking_bound_mm = 20.0;
  hal::TickRecord seen;
  seen.mode = hal::Mode::kTrack;
  seen.target_known = true;
  records_ = {seen};
  const auto behind = [](double m) { return [m](double) { return Eigen::Vector3d(0.0, 0.0, m); }; };
  const Summary near = Judge(2.0, behind(0.019));
  EXPECT_TRUE(near.converged);
  EXPECT_NEAR(*near.tracking_error_px_rms, 0.0, 1e-9);
  EXPECT_NEAR(*near.tracking_error_mm_rms, 19.0, 1e-9);
  const Summary far = Judge(2.0, behind(0.12));
  EXPECT_FALSE(far.converged);
  EXPECT_THAT(far.verdict, testing::HasSubstr("120.00 mm rms, bound 20 mm"));
}

// Without a camera: a motion that was aborted or never started counts as not followed.
TEST_F(VerdictTest, MotionThatWasGivenUpOrNeverBegunIsNotFollowed) {
  config_.has_eye = false;
  config_.has_motion = true;
  hal::TickRecord record;
  record.mode = hal::Mode::kMove;
  records_ = {record};
  const auto judge = [this] { return Judge(1.0, Still); };
  EXPECT_TRUE(judge().converged);
  EXPECT_EQ(judge().verdict, "the commanded motion was followed");
  for (const hal::HoldReason reason : {hal::HoldReason::kNotFollowed, hal::HoldReason::kMotionRefused}) {
    record.mode = hal::Mode::kHold;
    record.hold_reason = reason;
    records_ = {records_.front(), record};
    record.hold_reason = hal::HoldReason::kNotAsked;  // later records do not clear it
    records_.push_back(record);
    EXPECT_FALSE(judge().converged) << hal::Name(reason);
  }
  records_.resize(1);
  config_.circle = CommandedCircle{};
  config_.circle->lead_s = 5.0;
  EXPECT_FALSE(judge().converged);
  EXPECT_THAT(judge().verdict, testing::HasSubstr("before the circle began"));
  config_.circle.reset();
  config_.has_motion = false;
  EXPECT_EQ(judge().verdict, "no motion was commanded, and the arm stood still");
}

// A moving target is kept while its rms error over half a second is within the bound; a sample may exceed it.
TEST_F(VerdictTest, MovingTargetIsKeptByItsMeanErrorOverHalfASecond) {
  config_.target_moves = true;
  const double px = kGoalZ / config_.eye.pinhole.f_px;
  const Summary kept = Judge(3.0, [&](double t) {
    const bool peak = std::fmod(t, 0.1) < 0.01;
    return Eigen::Vector3d((t < 1.0 ? 50.0 : peak ? 5.0 : 1.0) * px, 0, 0);
  });
  ASSERT_TRUE(kept.end.goal_kept_since_s.has_value());
  EXPECT_NEAR(*kept.end.goal_kept_since_s, 1.5, 0.02);
  const Summary lost =
      Judge(3.0, [&](double t) { return Eigen::Vector3d((t < 2.4 ? 1.0 : 3.1) * px, 0, 0); });
  EXPECT_FALSE(lost.end.goal_kept_since_s.has_value());
}

TEST_F(VerdictTest, EveryExceededLimitIsCounted) {
  // Changes one tick; returns the number of violations.
  const auto violations = [&](const char* name, const std::function<void(Truth&)>& change) {
    const Summary s = Judge(0.1, Still, [&](Truth& truth) {
      if (truth.stamp_ns == 50 * kMs) {
        change(truth);
      }
    });
    EXPECT_EQ(s.limit_violations > 0, !s.violations.empty());
    return s.violations.count(name) > 0 ? s.violations.at(name) : 0U;
  };
  EXPECT_EQ(violations("joint_position", [](Truth& t) { t.q[1] = 1.77; }), 1U);     // +-1.7628 rad
  EXPECT_EQ(violations("joint_velocity", [](Truth& t) { t.dq[6] = -2.62; }), 1U);   // 2.61 rad/s
  EXPECT_EQ(violations("torque_rate", [](Truth& t) { t.tau_cmd[6] = 0.99; }), 0U);  // 1 Nm per tick
  EXPECT_EQ(violations("torque_rate", [](Truth& t) { t.tau_cmd[6] = 1.01; }), 2U);  // one step up, one down
  EXPECT_EQ(violations("workspace", [](Truth& t) { t.X_BE.translation().x() = 0.86; }), 1U);  // 0.85 m
  EXPECT_EQ(violations("torque", [](Truth& t) { t.tau_cmd[6] = -12.1; }), 1U);                // 12 Nm
}

TEST_F(VerdictTest, ExceededLimitFailsTheRunAndCountsOncePerTick) {
  hal::TickRecord record;
  record.stamp_ns = 50 * kMs;
  record.ddq_cmd[0] = 2.0 * config_.barriers.arm.joints[0].ddq_max;
  records_ = {record};
  // The truth exceeds a limit in the same tick, and in one more.
  const Summary s = Judge(1.0, Still, [](Truth& truth) {
    if (truth.stamp_ns == 50 * kMs || truth.stamp_ns == 70 * kMs) {
      truth.q[1] = 1.77;
    }
  });
  EXPECT_TRUE(s.converged);
  EXPECT_EQ(s.limit_violations, 2U);
  EXPECT_EQ(s.verdict, "converged, but a limit was exceeded in 2 ticks");
  EXPECT_FALSE(ReachedItsGoal(s));
  records_.clear();
  EXPECT_TRUE(ReachedItsGoal(Judge(1.0, Still)));
}

// Any contact fails the run, even if the target ends at its goal.
TEST_F(VerdictTest, AnyContactFailsTheRun) {
  for (const auto& [contacts, what] : {std::pair{Contacts{1, false, false}, "the bench"},
                                       {Contacts{0, true, false}, "the target"},
                                       {Contacts{0, false, true}, "itself"}}) {
    const Contacts at_once = contacts;  // a lambda of C++17 captures no structured binding
    const Summary s = Judge(1.0, Still, [&at_once](Truth& truth) {
      truth.contacts = truth.stamp_ns == 50 * kMs ? at_once : Contacts{};
    });
    EXPECT_FALSE(s.converged);
    EXPECT_FALSE(ReachedItsGoal(s));
    EXPECT_EQ(s.contact_ticks, 1U);
    EXPECT_EQ(s.limit_violations, 1U);
    EXPECT_EQ(s.verdict, std::string("not converged: the arm touched ") + what + " in 1 ticks");
  }
}

TEST_F(VerdictTest, SeenTooSeldomAndNeverSeenHaveDifferentVerdicts) {
  const auto far = [](double) { return Eigen::Vector3d(0.1, 0.0, 0.0); };
  frames_detected_ = 0;
  EXPECT_THAT(Judge(0.1, far).verdict, testing::HasSubstr("never found in view"));
  frames_ = 0;
  EXPECT_THAT(Judge(0.1, far).verdict, testing::HasSubstr("never found in view"));
  frames_lost_ = 24;
  EXPECT_THAT(Judge(0.1, far).verdict, testing::HasSubstr("all 24 frames were lost"));
  frames_ = 1;
  EXPECT_THAT(Judge(0.1, far).verdict, testing::HasSubstr("never found in view"));
  frames_ = frames_detected_ = 2;
  EXPECT_THAT(Judge(0.1, far).verdict, testing::HasSubstr("found in 2 frames, too few"));
}

TEST_F(VerdictTest, FaultFailsTheRunAndIsNamed) {
  hal::TickRecord record;
  record.stamp_ns = 250 * kMs;
  record.mode = hal::Mode::kFault;
  record.fault = hal::Fault::kJointVelocity;
  record.fault_joint = 3;
  records_ = {record, record};
  const Summary s = Judge(1.0, Still);
  EXPECT_FALSE(s.converged);
  ASSERT_EQ(s.faults.size(), 1U);
  EXPECT_EQ(s.faults[0].fault, hal::Fault::kJointVelocity);
  EXPECT_EQ(s.faults[0].joint, 3);
  EXPECT_THAT(ToJson(s), testing::HasSubstr("\"detail\": \"joint 4\""));
  EXPECT_DOUBLE_EQ(s.faults[0].t_s, 0.25);
  EXPECT_EQ(s.verdict,
            "not converged: fault: a joint's velocity exceeded its limit, or jumped (joint_velocity), at "
            "0.250 s, joint 4; see "
            "arm.model");
  EXPECT_THAT(ToTable(s),
              testing::HasSubstr("faults                  a joint's velocity exceeded its limit, or jumped "
                                 "(joint_velocity), at\n" +
                                 std::string(26, ' ') + "0.250 s, joint 4; see arm.model\n"));
}

TEST_F(VerdictTest, HoldIsExplainedInWords) {
  hal::TickRecord record;
  record.stamp_ns = 1588 * kMs;
  record.mode = hal::Mode::kHold;
  record.hold_reason = hal::HoldReason::kTargetLost;
  record.target_known = true;
  records_ = {record};
  const Summary s = Judge(2.0, [](double) { return Eigen::Vector3d(0.1, 0.0, 0.0); });
  EXPECT_EQ(s.verdict,
            "not converged: the arm has held since 1.588 s because the target was lost (target_lost)");
  EXPECT_EQ(s.end.reason, "target_lost");
  records_[0].hold_reason = hal::HoldReason::kEyeDoubted;
  EXPECT_THAT(Judge(2.0, [](double) { return Eigen::Vector3d(0.1, 0.0, 0.0); }).verdict,
              testing::EndsWith("(eye_doubted); see camera.mount_xyz, camera.mount_rpy_deg, "
                                "servo.way_in_vain"));
}

TEST_F(VerdictTest, LimitsThatActedAreNamedTheLongestFirst) {
  const auto far = [](double) { return Eigen::Vector3d(0.1, 0.0, 0.0); };
  hal::TickRecord record;
  record.mode = hal::Mode::kTrack;
  record.target_known = true;
  records_.assign(1000, record);
  EXPECT_THAT(Judge(1.0, far).verdict, testing::Not(testing::HasSubstr("limited by")));
  for (std::size_t k = 0; k < records_.size(); ++k) {
    records_[k].limits_active =
        (k < 5 ? hal::Bit(hal::Limit::kObstacle) : 0U) | (k < 890 ? hal::Bit(hal::Limit::kFieldOfView) : 0U) |
        (k < 60 ? hal::Bit(hal::Limit::kJointJerk) : 0U) | (k < 49 ? hal::Bit(hal::Limit::kSingularity) : 0U);
  }
  EXPECT_THAT(Judge(1.0, far).verdict,
              testing::EndsWith("of its goal; limited by field_of_view (safety.view_margin_px) in 89 %, "
                                "joint_jerk (safety.joint_jerk_fraction) in 6 % of its motion"));
  config_.barriers.obstacles.num_boxes = 1;
  EXPECT_THAT(
      Judge(1.0, far).verdict,
      testing::HasSubstr("field_of_view (safety.view_margin_px, safety.sight_clearance, safety.boxes) in"))
      << "a box in the line of sight is not at the picture's edge";
  config_.barriers.obstacles.num_boxes = 0;
  record.mode = hal::Mode::kHold;
  records_.insert(records_.end(), 30'000, record);
  EXPECT_THAT(Judge(31.0, far).verdict, testing::HasSubstr("limited by field_of_view"))
      << "a long stop afterwards hides the limit that caused it";
}

TEST(SummaryTableTest, RowsSayInWordsWhatVisionDelivered) {
  Summary s;
  s.frames = 55;
  s.frames_lost = 35;
  s.frames_detected = 40;
  s.measurements = {{"taken", 36}, {"not_found", 15}, {"outlier", 4}, {"too_old", 1}};
  const std::string table = ToTable(s);
  EXPECT_THAT(table, testing::HasSubstr("  frames                  90, lost 35, target found in 40\n"));
  EXPECT_THAT(table,
              testing::HasSubstr("  measurements            36 taken, 1 too old, 4 rejected as outlier\n"));
  s.frames_lost = 0;
  EXPECT_THAT(ToTable(s), testing::HasSubstr("  frames                  55, target found in 40\n"));
}

TEST(SummaryTableTest, FitsItsWidthAndPaintsTheVerdict) {
  Summary s;
  s.verdict = "not converged: the target was lost";
  for (const char* name : {"cartesian_speed", "joint_acceleration", "joint_jerk", "joint_position"}) {
    s.limits[name] = 0.5;
  }
  for (const std::size_t width : {60U, 80U, 100U}) {
    std::istringstream lines(ToTable(s, {.width = width, .colour = false}));
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), width) << line;
    }
  }
  const config::TextStyle coloured{.width = 100, .colour = true};
  EXPECT_THAT(ToTable(s, coloured),
              testing::HasSubstr("\033[31mnot converged: the target was lost\033[0m\n"));
  s.converged = true;
  s.verdict = "converged";
  EXPECT_THAT(ToTable(s, coloured), testing::HasSubstr("\033[32mconverged\033[0m\n"));
  EXPECT_THAT(ToTable(s), testing::Not(testing::HasSubstr("\033")));
}

}  // namespace
}  // namespace fovea::sim
