// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/arm_estimate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/host/beliefs/synthetic_run.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::beliefs {
namespace {

model::Load Camera() {
  model::Load load;
  load.mass = 0.25;
  load.p_ECom = {0.05, 0.0, 0.02};
  return load;
}

// `rotor_inertia` [kg m^2]: of every joint.
ArmEstimate RunOnce(const test::JointPath& path, const test::SyntheticTruth& truth, unsigned seed,
                    double rotor_inertia = 0.0) {
  config::ServoConfig config = test::PandaConfig();
  model::Attach(Camera(), config.arm);
  for (model::Joint& joint : config.arm.joints) {
    joint.rotor_inertia = rotor_inertia;
  }
  ArmEstimator estimator(config, Camera());
  test::SyntheticNoise noise;
  test::MakeRun(config, path, {model::Mat3::Identity(), test::BallPlace()}, truth, noise, 6.0, seed,
                [&](const hal::TickRecord& record) { estimator.Add(record); });
  return estimator.Estimate();
}

const Belief& Find(const ArmEstimate& estimate, const std::string& name) {
  for (const Belief& belief : estimate.beliefs) {
    if (belief.name == name) {
      return belief;
    }
  }
  throw std::logic_error("there is no belief " + name);
}

TEST(ArmEstimateTest, FindsLoadAndFriction) {
  constexpr int kRuns = 60;
  int load_known = 0;
  int load_within = 0;
  int centre_within = 0;
  int coulomb_within = 0;
  double sigma_most = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    test::RandomStates random(static_cast<unsigned>(run));
    test::SyntheticTruth truth;
    truth.load.mass = random.Uniform(0.05, 0.5);
    truth.load.p_ECom = Camera().p_ECom + random.Vector(0.03);
    truth.link_mass = random.Joints(test::Panda().model, 0.017);  // uniform, of a standard deviation of 1 %
    truth.bias = random.Joints(test::Panda().model, 0.02);
    truth.viscous = random.Uniform(0.0, 0.5);
    truth.coulomb = random.Uniform(0.0, 0.5);
    const ArmEstimate estimate =
        RunOnce(test::LookAround(), truth, static_cast<unsigned>(run), 0.3 * (run % 2));
    const Belief& load = Find(estimate, "load");
    load_known += load.IsKnown() ? 1 : 0;
    load_within += std::fabs(load.difference - truth.load.mass) <= 2.0 * load.sigma ? 1 : 0;
    sigma_most = std::max(sigma_most, load.sigma);
    const Belief& centre = Find(estimate, "centre of the load along the hand's x axis");
    const double true_shift =
        truth.load.mass * (truth.load.p_ECom - Camera().p_ECom).x() / (truth.load.mass + Camera().mass);
    centre_within += std::fabs(centre.difference - true_shift) <= 2.0 * centre.sigma ? 1 : 0;
    const Belief& coulomb = Find(estimate, "Coulomb friction left in joint 4");
    EXPECT_TRUE(coulomb.IsKnown());
    EXPECT_NEAR(coulomb.difference, truth.coulomb, 0.03);
    coulomb_within += std::fabs(coulomb.difference - truth.coulomb) <= 2.0 * coulomb.sigma ? 1 : 0;
    EXPECT_NEAR(Find(estimate, "viscous friction left in joint 7").difference, truth.viscous, 0.05);
  }
  fmt::print(
      "load known in {} of {}, within 2 sigma in {}, sigma at most {:.4f} kg; centre within in {}; "
      "Coulomb friction within in {}\n",
      load_known, kRuns, load_within, sigma_most, centre_within, coulomb_within);
  EXPECT_EQ(load_known, kRuns);
  EXPECT_GE(load_within, 0.9 * kRuns);
  EXPECT_GE(centre_within, 0.9 * kRuns);
  EXPECT_LE(sigma_most, 0.05);
}

// Ten times the errors that are taken for granted: the windows tell so, and the load is less sure.
TEST(ArmEstimateTest, MassesThatAreFarFromTheirStatementMakeTheLoadLessSure) {
  constexpr int kRuns = 40;
  int within = 0;
  double surest = 1e9;
  double farthest = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    test::RandomStates random(1000U + static_cast<unsigned>(run));
    test::SyntheticTruth truth;
    truth.load.mass = random.Uniform(-0.15, 0.3);
    truth.load.p_ECom = Camera().p_ECom;
    truth.link_mass = random.Joints(test::Panda().model, 0.17);
    truth.bias = random.Joints(test::Panda().model, 0.02);
    const ArmEstimate estimate = RunOnce(test::LookAround(), truth, static_cast<unsigned>(run));
    const Belief& load = Find(estimate, "load");
    const double sigmas = std::fabs(load.difference - truth.load.mass) / load.sigma;
    within += sigmas <= 2.0 ? 1 : 0;
    farthest = std::max(farthest, sigmas);
    surest = std::min(surest, load.sigma);
  }
  fmt::print("within 2 sigma in {} of {}, farthest {:.1f} sigma, smallest sigma {:.3f} kg\n", within, kRuns,
             farthest, surest);
  EXPECT_GE(within, 0.8 * kRuns);
  EXPECT_LT(farthest, 5.0);  // the size of the errors is itself estimated, from few of them
}

TEST(ArmEstimateTest, FrictionOfAJointThatStandsIsUnknown) {
  test::Waves waves = test::LookAround();
  waves.amplitude[2] = 0.0;
  const ArmEstimate estimate = RunOnce(waves, {}, 1);
  EXPECT_FALSE(Find(estimate, "viscous friction left in joint 3").IsKnown());
  EXPECT_FALSE(Find(estimate, "Coulomb friction left in joint 3").IsKnown());
  EXPECT_TRUE(Find(estimate, "Coulomb friction left in joint 4").IsKnown());
}

TEST(ArmEstimateTest, AShortRunTellsNothing) {
  const config::ServoConfig config = test::PandaConfig();
  ArmEstimator estimator(config, {});
  test::MakeRun(config, test::LookAround(), {model::Mat3::Identity(), test::BallPlace()}, {}, {}, 0.5, 1,
                [&](const hal::TickRecord& record) { estimator.Add(record); });
  EXPECT_EQ(estimator.Estimate().windows, 0);
  EXPECT_TRUE(estimator.Estimate().beliefs.empty());
}

}  // namespace
}  // namespace fovea::beliefs
