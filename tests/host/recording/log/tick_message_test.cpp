// SPDX-License-Identifier: Apache-2.0
// Converting a record to a log message and back keeps every bit.
#include "firmware/host/recording/log/tick_message.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "firmware/host/recording/log/record_hash.hpp"
#include "fovea/tick.pb.h"

namespace fovea::log {
namespace {

std::string HashOf(const hal::TickRecord& record) {
  RecordHash hash;
  hash.Add(record);
  return hash.Finish();
}

// Random doubles of any bit pattern, including NaN with a payload, infinities, subnormal numbers and -0.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double Double() {
    static constexpr double kSpecial[] = {0.0, -0.0, std::numeric_limits<double>::infinity(),
                                          std::numeric_limits<double>::quiet_NaN(),
                                          std::numeric_limits<double>::denorm_min()};
    const std::uint64_t bits = engine_();
    return bits % 4 == 0 ? kSpecial[bits / 4 % 5] : std::bit_cast<double>(engine_());
  }
  std::int64_t Whole(std::int64_t max) {
    return static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(max + 1));
  }
  template <std::size_t N>
  void Fill(std::array<double, N>& values, int count) {
    for (int i = 0; i < count; ++i) {
      values[static_cast<std::size_t>(i)] = Double();
    }
  }

 private:
  std::mt19937_64 engine_;
};

hal::FeatureMeasurement RandomFeature(Random& random) {
  hal::FeatureMeasurement f;
  f.stamp_ns = random.Whole(std::numeric_limits<std::int64_t>::max() - 1);
  f.sequence = static_cast<std::uint64_t>(random.Whole(1'000'000));
  f.found = random.Whole(1) == 1;
  f.confidence = random.Double();
  f.dim = static_cast<std::int32_t>(random.Whole(hal::kMaxFeatureDim));
  random.Fill(f.s, f.dim);
  for (int row = 0; row < f.dim; ++row) {
    for (int col = 0; col < f.dim; ++col) {
      f.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)] = random.Double();
    }
  }
  f.num_poses = static_cast<std::int32_t>(random.Whole(hal::kMaxPoses));
  for (std::size_t i = 0; i < static_cast<std::size_t>(f.num_poses); ++i) {
    random.Fill(f.poses[i].p_CO_C, 3);
    random.Fill(f.poses[i].q_CO, 4);
    f.poses[i].first = static_cast<std::int32_t>(random.Whole(3));
  }
  return f;
}

hal::TickRecord RandomRecord(Random& random) {
  hal::TickRecord r;
  r.tick = static_cast<std::uint64_t>(random.Whole(std::numeric_limits<std::int64_t>::max() - 1));
  r.stamp_ns = random.Whole(std::numeric_limits<std::int64_t>::max() - 1) - 1'000'000'000;
  r.missed_ticks = static_cast<std::int32_t>(random.Whole(100));
  r.arm.stamp_ns = -random.Whole(1'000'000);
  r.arm.sequence = ~std::uint64_t{0} - static_cast<std::uint64_t>(random.Whole(5));
  r.arm.num_joints = r.command.num_joints = static_cast<std::int32_t>(random.Whole(hal::kMaxJoints));
  const int n = r.arm.num_joints;
  for (auto* values : {&r.arm.q, &r.arm.dq, &r.arm.tau_meas, &r.arm.tau_applied, &r.q_cmd, &r.dq_cmd,
                       &r.ddq_cmd, &r.tau_ext, &r.command.tau_cmd}) {
    random.Fill(*values, n);
  }
  r.has_feature = random.Whole(1) == 1;
  r.feature = RandomFeature(random);
  r.tuning.result = static_cast<hal::TuningResult>(random.Whole(hal::kNumTuningResults - 1));
  if (r.tuning.result != hal::TuningResult::kNone) {
    r.tuning.key = static_cast<std::int32_t>(random.Whole(20)) - 3;
    r.tuning.before = random.Double();
    r.tuning.asked = random.Double();
  }
  r.mode = static_cast<hal::Mode>(random.Whole(4));
  r.hold_reason = static_cast<hal::HoldReason>(random.Whole(4));
  r.fault = static_cast<hal::Fault>(random.Whole(hal::kNumFaults - 1));
  r.fault_joint = static_cast<std::int32_t>(random.Whole(8)) - 1;
  r.limits_active = static_cast<hal::LimitSet>(random.Whole(127));
  r.target_known = random.Whole(1) == 1;
  r.feature_age_ns = random.Whole(1'000'000'000);
  random.Fill(r.p_BO, 3);
  random.Fill(r.q_BO, 4);
  random.Fill(r.v_BO, 3);
  r.stamp_late_s = 1e-3 * static_cast<double>(random.Whole(60)) - 0.03;
  r.stamp_late_sigma_s = 1e-3 * static_cast<double>(random.Whole(60));
  r.dim = static_cast<std::int32_t>(random.Whole(hal::kMaxFeatureDim));
  random.Fill(r.s, r.dim);
  random.Fill(r.s_star, r.dim);
  random.Fill(r.e, r.dim);
  random.Fill(r.V_BC_C_cmd, 6);
  r.way.way = static_cast<hal::Way>(random.Whole(hal::kNumWays - 1));
  r.way.event = static_cast<hal::PlanEvent>(random.Whole(hal::kNumPlanEvents - 1));
  r.way.plans_asked = static_cast<std::int32_t>(random.Whole(1000));
  r.way.tries = static_cast<std::int32_t>(random.Whole(10));
  r.way.outcome = static_cast<std::int32_t>(random.Whole(20)) - 5;
  random.Fill(r.way.normal_B, 3);
  r.command.state_sequence = static_cast<std::uint64_t>(random.Whole(1'000'000));
  r.command.engage_brakes = random.Whole(1) == 1;
  return r;
}

TEST(TickMessageTest, KeepsEveryBitOfRandomRecords) {
  Random random(3);
  Tick tick;  // reused, as in the log
  Feature feature;
  for (int i = 0; i < 5000; ++i) {
    const hal::TickRecord record = RandomRecord(random);
    ToMessage(record, tick);
    ToMessage(record.feature, feature);
    Tick read_tick;
    Feature read_feature;
    ASSERT_TRUE(read_tick.ParseFromString(tick.SerializeAsString()));
    ASSERT_TRUE(read_feature.ParseFromString(feature.SerializeAsString()));
    ASSERT_EQ(HashOf(FromMessage(read_tick, FromMessage(read_feature))), HashOf(record)) << "record " << i;
  }
}

TEST(TickMessageTest, TuningNamesItsKeyAndTheRefusal) {
  const auto words = [](const hal::TuningNote& note) {
    hal::TickRecord record;
    record.tuning = note;
    Tick tick;
    ToMessage(record, tick);
    return InWords(tick.tuning());
  };
  EXPECT_EQ(words({hal::TuningResult::kTaken, 0, 2.0, 4.0}), "servo.lambda 2 -> 4 1/s, in motion");
  EXPECT_EQ(words({hal::TuningResult::kTaken, 3, 0.05, 0.125}), "servo.damping 0.05 -> 0.125, in motion");
  EXPECT_EQ(words({hal::TuningResult::kOutOfRange, 0, 2.0, 40.0}),
            "servo.lambda 2 -> 40 1/s, in motion, refused: the value is outside the key's range");
  EXPECT_EQ(words({hal::TuningResult::kUnknownKey, 15, 0.0, 4.0}),
            "key 15 0 -> 4, in motion, refused: no such key changes in motion");
  Tick tick;
  ToMessage(hal::TickRecord{}, tick);
  EXPECT_FALSE(tick.has_tuning()) << "a tick without a request is as in older logs";
}

TEST(TickMessageTest, WayTellsWhatHappenedToAPlan) {
  const auto words = [](hal::PlanEvent event, int outcome) {
    hal::TickRecord record;
    record.way.event = event;
    record.way.outcome = outcome;
    Tick tick;
    ToMessage(record, tick);
    return InWords(tick.way());
  };
  EXPECT_EQ(words(hal::PlanEvent::kNone, 6), "") << "nothing to tell";
  EXPECT_EQ(words(hal::PlanEvent::kAsked, 6), "a plan to the goal is asked for");
  EXPECT_EQ(words(hal::PlanEvent::kLate, 6), "no plan came in time: the visual law goes on alone");
  EXPECT_EQ(words(hal::PlanEvent::kNoMotion, 6),
            "no plan: the visual law goes on alone: no posture was found that reaches the goal inside the "
            "joints' ranges");
  for (const int unknown : {-1, 10, 1'000'000}) {
    EXPECT_EQ(words(hal::PlanEvent::kNoMotion, unknown), "no plan: the visual law goes on alone");
  }
}

TEST(TickMessageTest, RefusesMoreEntriesThanTheServoHas) {
  Tick tick;
  for (int i = 0; i < hal::kMaxJoints + 1; ++i) {
    tick.mutable_arm()->add_q(0.0);
  }
  EXPECT_THROW(FromMessage(tick, {}), std::runtime_error);
  Feature feature;
  feature.add_s(1.0);
  EXPECT_THROW(FromMessage(feature), std::runtime_error) << "its covariance is missing";
}

}  // namespace
}  // namespace fovea::log
