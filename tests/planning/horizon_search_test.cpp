// SPDX-License-Identifier: Apache-2.0
// Horizons of a predictive law, on an arm that follows exactly. Each is followed for 40 ms, as in the tick.
#include "firmware/planning/horizon_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "firmware/planning/planner.hpp"
#include "firmware/planning/time_path.hpp"
#include "tests/planning/starts.hpp"

namespace fovea {
namespace {

using planning::HorizonSearch;
using planning::Work;
using trajectory::Plan;
using trajectory::PlanOutcome;
using trajectory::PlanRequest;

constexpr double kStepS = 0.04;
constexpr std::int64_t kBudget = 100'000;

// A target to whose goal the arm's ready posture leads, and a start that is `spread` [rad, m] off it.
PlanRequest NearReady(const config::ServoConfig& config, unsigned seed, double spread) {
  const int n = config.arm.num_joints;
  const model::VecN ready = model::ToVector(config.arm.q_ready, n);
  model::ArmPoses poses;
  model::ComputePoses(config.arm, ready, poses);
  PlanRequest request;
  request.kind = PlanRequest::Kind::kHorizon;
  request.X_BO = poses.X_BE * config.X_EC * model::Pose{config.feature.R_CO_star, config.feature.p_CO_C_star};
  request.start.q = ready;
  test::RandomStates random(seed);
  for (int i = 0; i < n; ++i) {
    request.start.q[i] += random.Uniform(-spread, spread);
  }
  request.start.dq.setZero(n);
  request.start.ddq.setZero(n);
  request.q_off.setZero(n);
  return request;
}

class Loop {
 public:
  explicit Loop(const config::ServoConfig& config) : config_(config), search_(config) {
    plan_.num_joints = config.arm.num_joints;
  }

  // Asks for a horizon and follows it for a step. False if there is none.
  bool Step(PlanRequest& request) {
    Work work(kBudget);
    const PlanOutcome outcome = search_.Search(request, work, plan_);
    EXPECT_TRUE(work.IsLeft());
    if (outcome != PlanOutcome::kFound) {
      return false;
    }
    plan_.outcome = outcome;
    EXPECT_TRUE(plan_.IsSound());
    Watch();
    trajectory::Reference at;
    plan_.At(0.0, at);
    jump_ = std::max({jump_, (at.q - request.start.q).norm(), (at.dq - request.start.dq).norm(),
                      1e-2 * (at.ddq - request.start.ddq).norm()});
    plan_.At(kStepS, at);
    request.start = at;
    request.X_BO.p += kStepS * request.v_BO;
    return true;
  }
  // Size of the feature's error, as a share of the goal's.
  [[nodiscard]] double ErrorAt(const PlanRequest& request) const {
    features::FeatureState feature;
    EXPECT_TRUE(config_.feature.Compute(Seen(request), feature));
    return (feature.s - feature.s_star).norm() / feature.s_star.norm();
  }
  // Before the picture's edges, normalised.
  [[nodiscard]] double RoomAt(const PlanRequest& request) const {
    model::Mat6N J;
    J.setZero(6, config_.arm.num_joints);
    double least = HUGE_VAL;
    for (const barriers::Barrier& side :
         barriers::FieldOfViewBarriers(config_.guard, {config_.feature.Outline(), Seen(request), J})) {
      least = std::min(least, side.value);
    }
    return least;
  }

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] double most() const { return most_; }
  [[nodiscard]] double jump() const { return jump_; }

 private:
  [[nodiscard]] features::TargetInCamera Seen(const PlanRequest& request) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, request.start.q, poses);
    return {(poses.X_BE * config_.X_EC).Inverse() * request.X_BO};
  }
  // Velocity and acceleration at 1 kHz, of what a plan may use.
  void Watch() {
    const planning::JointLimits limits = planning::LimitsOfPlan(config_);
    trajectory::Reference at;
    for (double t = 0.0; t < plan_.Duration(); t += 1e-3) {
      plan_.At(t, at);
      for (int j = 0; j < plan_.num_joints; ++j) {
        const auto k = static_cast<std::size_t>(j);
        most_ =
            std::max({most_, std::fabs(at.dq[j]) / limits[k].v_max, std::fabs(at.ddq[j]) / limits[k].a_max});
      }
    }
  }

  const config::ServoConfig& config_;
  HorizonSearch search_;
  Plan plan_;
  double most_ = 0.0;
  double jump_ = 0.0;
};

class Horizons : public testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  config::ServoConfig config_ = test::PlannedServo(GetParam().first, GetParam().second);
};

// From near the goal no limit acts: the error decays like that of the other laws.
TEST_P(Horizons, ErrorDecaysWithTheLawsGain) {
  for (const double gain : {0.5, 1.5, 3.0, 6.0}) {
    config_.law.lambda = gain;
    config_.law.lambda_near = 0.0;
    Loop loop(config_);
    PlanRequest request = NearReady(config_, 3, 0.03);
    for (int k = 0; k < 10; ++k) {  // the arm gathers speed
      ASSERT_TRUE(loop.Step(request));
    }
    const double begin = loop.ErrorAt(request);
    for (int k = 0; k < 15; ++k) {
      ASSERT_TRUE(loop.Step(request));
    }
    const double rate = std::log(begin / loop.ErrorAt(request)) / (15 * kStepS);
    std::cout << "gain " << gain << " 1/s: the error decays with " << rate << " 1/s\n";
    EXPECT_NEAR(rate, gain, 0.03 * gain);
  }
}

TEST_P(Horizons, BeginsAsTheArmMovesAndKeepsItsLimits) {
  Loop loop(config_);
  double last = 0.0;
  constexpr int kRuns = 6;
  int runs = 0;
  for (unsigned seed = 1; seed <= 60 && runs < kRuns; ++seed) {
    PlanRequest request = NearReady(config_, seed, 0.3);
    if (loop.RoomAt(request) < 0.02) {
      continue;
    }
    for (int k = 0; k < 75 && loop.Step(request); ++k) {
    }
    last = std::max(last, loop.ErrorAt(request));
    ++runs;
  }
  std::cout << "largest velocity or acceleration, of what a plan may use: " << loop.most() << ", jump "
            << loop.jump() << ", last error " << last << "\n";
  EXPECT_EQ(runs, kRuns) << "starts with the target in the picture";
  EXPECT_LT(loop.most(), 1.05);
  EXPECT_LT(loop.jump(), 1e-9);
  EXPECT_LT(last, 0.02);
}

INSTANTIATE_TEST_SUITE_P(All, Horizons,
                         testing::Values(std::pair{"panda", "sphere"}, std::pair{"panda", "circle"},
                                         std::pair{"panda", "square"}, std::pair{"panda", "triangle"},
                                         std::pair{"ur5e", "square"}),
                         [](const auto& c) { return std::string(c.param.first) + "_" + c.param.second; });

class HorizonTest : public testing::Test {
 protected:
  config::ServoConfig config_ = test::PlannedServo("panda", "square");
};

TEST_F(HorizonTest, EndsAtRest) {
  Loop loop(config_);
  PlanRequest request = NearReady(config_, 1, 0.3);
  ASSERT_TRUE(loop.Step(request));
  trajectory::Reference end;
  loop.plan().At(loop.plan().Duration() - 1e-9, end);
  EXPECT_LT(end.dq.norm(), 1e-9);
  EXPECT_LT(end.ddq.norm(), 1e-6);
}

// The goal has a corner of the target past the picture's edge.
TEST_F(HorizonTest, TargetStaysInThePicture) {
  PlanRequest request = NearReady(config_, 1, 0.0);  // for the goal in the middle
  config_.feature.p_CO_C_star.x() += 0.2;
  config_.law.lambda = 4.0;
  Loop loop(config_);
  const double begin = loop.RoomAt(request);
  double least = begin;
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(loop.Step(request));
    least = std::min(least, loop.RoomAt(request));
  }
  std::cout << "room before the picture's edge: " << begin << " at the start, " << least << " at least\n";
  EXPECT_GT(least, -0.01) << "5 px, which the tick does not allow";
  EXPECT_LT(least, 0.02) << "it goes as near as it may";
}

// The error of a law without a prediction would be speed / gain: 0.025 m.
TEST_F(HorizonTest, MovingTargetIsFollowedWithoutLag) {
  config_.law.lambda = 2.0;
  Loop loop(config_);
  PlanRequest request = NearReady(config_, 1, 0.0);
  request.v_BO = {0.0, 0.05, 0.0};
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(loop.Step(request));
  }
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, request.start.q, poses);
  const model::Pose X_CO = (poses.X_BE * config_.X_EC).Inverse() * request.X_BO;
  const double lag = (X_CO.p - config_.feature.p_CO_C_star).norm();
  std::cout << "lag behind 0.05 m/s: " << lag << " m\n";
  EXPECT_LT(lag, 0.001);
}

// A square that is turned by 100 degrees looks as if turned by 10.
TEST_F(HorizonTest, NearestOfTheEqualGoalsIsTaken) {
  Loop loop(config_);
  PlanRequest request = NearReady(config_, 1, 0.0);
  request.X_BO.R = request.X_BO.R * model::RotationOf(model::Vec3(0.0, 0.0, 1.75));
  const model::VecN start = request.start.q;
  for (int k = 0; k < 75; ++k) {
    ASSERT_TRUE(loop.Step(request));
    EXPECT_NE(loop.plan().turn, 0);
  }
  EXPECT_LT((request.start.q - start).lpNorm<Eigen::Infinity>(), 0.35);
  EXPECT_GT((request.start.q - start).lpNorm<Eigen::Infinity>(), 0.1);
}

// An arm that stands off its reference: the camera is where the measured joints are.
TEST_F(HorizonTest, StandingOffsetOfTheJointsIsAllowedFor) {
  Loop loop(config_);
  PlanRequest request = NearReady(config_, 1, 0.0);
  request.q_off = model::VecN::Constant(7, 0.01);
  for (int k = 0; k < 150; ++k) {
    ASSERT_TRUE(loop.Step(request));
  }
  PlanRequest measured = request;
  measured.start.q += request.q_off;
  EXPECT_GT(loop.ErrorAt(request), 5e-3);
  EXPECT_LT(loop.ErrorAt(measured), 1e-3);
}

// An arm that is behind its reference while it moves: at rest it is there.
TEST_F(HorizonTest, LagOfTheArmEndsWithItsMotion) {
  config_.law.lambda = 8.0;
  const auto error_at_the_end = [this](double lag_s) {
    PlanRequest request = NearReady(config_, 1, 0.1);
    request.start.dq = model::VecN::Constant(7, 0.2);
    request.q_off = -lag_s * request.start.dq;
    Loop loop(config_);
    EXPECT_TRUE(loop.Step(request));
    loop.plan().At(loop.plan().Duration(), request.start);
    return loop.ErrorAt(request);
  };
  const double without = error_at_the_end(0.0);
  const double with = error_at_the_end(0.05);
  std::cout << "error at the end " << without << ", of an arm 10 mrad behind " << with << "\n";
  EXPECT_LT(with, without + 0.001);
}

TEST_F(HorizonTest, SameRequestHasTheSameAnswer) {
  const PlanRequest request = NearReady(config_, 4, 0.3);
  const PlanRequest other = NearReady(config_, 5, 0.3);
  planning::Planner planner(config_);
  Plan first;
  Plan second;
  planner.Compute(request, first);
  const std::int64_t work = planner.effort().work;
  ASSERT_TRUE(first.IsFound());
  planner.Compute(other, second);
  EXPECT_NE(first.points, second.points);
  planner.Compute(request, second);
  EXPECT_EQ(first.points, second.points);
  EXPECT_EQ(planner.effort().work, work);
  EXPECT_GT(work, 100);
  EXPECT_LT(work, 5000) << "12 ms on the modelled processor";
}

TEST_F(HorizonTest, BadRequestIsRefused) {
  planning::Planner planner(config_);
  Plan plan;
  const double nan = std::nan("");
  const PlanRequest sound = NearReady(config_, 4, 0.3);
  const auto outcome = [&](auto change) {
    PlanRequest request = sound;
    change(request);
    planner.Compute(request, plan);
    EXPECT_TRUE(plan.IsSound());
    return plan.outcome;
  };
  EXPECT_EQ(outcome([](PlanRequest&) {}), PlanOutcome::kFound);
  EXPECT_EQ(outcome([&](PlanRequest& r) { r.start.dq[2] = nan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([&](PlanRequest& r) { r.v_BO.x() = nan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([&](PlanRequest& r) { r.q_off[0] = nan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.q_off.resize(3); }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.X_BO.p.z() += 3.0; }), PlanOutcome::kTargetNotInSight)
      << "behind the camera";
  for (const double huge : {1e6, 1e150}) {
    EXPECT_NO_FATAL_FAILURE(outcome([huge](PlanRequest& r) { r.start.dq[1] = huge; }));
  }
}

}  // namespace
}  // namespace fovea
