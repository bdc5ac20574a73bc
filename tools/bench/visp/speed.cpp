// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/visp/speed.hpp"

#include <array>
#include <random>
#include <stdexcept>

#include "firmware/core/control/resolve_damped.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/features/point.hpp"
#include "tools/bench/common/spread.hpp"
#include "tools/bench/visp/law.hpp"

namespace fovea::bench {
namespace {

constexpr int kCases = 500;
constexpr int kRounds = 41;
constexpr std::size_t kPoints = 4;
constexpr double kLambda = 2.0;          // [1/s]
constexpr double kSmallestRatio = 1e-6;  // relative singular value down to which both inverses are exact
constexpr double kSame = 1e-9;           // largest relative difference of the twists

struct Case {
  std::array<model::Vec3, kPoints> p_C;
  model::Vec6 V = model::Vec6::Zero();  // camera twist, from the law that ran last
};

// Four corners of a square at about 0.4 m.
std::vector<Case> RandomCases() {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Case> cases(kCases);
  for (Case& c : cases) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double x = (k % 2 == 0 ? -0.12 : 0.12) + 0.03 * unit(engine);
      const double y = (k < 2 ? -0.12 : 0.12) + 0.03 * unit(engine);
      const double Z = 0.4 + 0.05 * unit(engine);
      c.p_C[k] = {x * Z, y * Z, Z};
    }
  }
  return cases;
}

constexpr std::array<std::array<double, 2>, kPoints> kGoal{
    {{-0.1, -0.1}, {0.1, -0.1}, {-0.1, 0.1}, {0.1, 0.1}}};
constexpr double kGoalDepth = 0.5;

class FoveaLaw {
 public:
  FoveaLaw() {
    config_.lambda = kLambda;
    config_.lambda_near = 0.0;
    camera_.num_joints = 6;
    exact_.threshold = kSmallestRatio;
    feature_.s.resize(2 * kPoints);
    feature_.s_star.resize(2 * kPoints);
    feature_.L_s.resize(2 * kPoints, 6);
    feature_.ds_dt_target = features::FeatureVector::Zero(2 * kPoints);
    for (std::size_t k = 0; k < kPoints; ++k) {
      feature_.s_star.segment<2>(static_cast<Eigen::Index>(2 * k)) << kGoal[k][0], kGoal[k][1];
    }
  }
  void Compute(Case& c) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      features::ImagePoint point;
      static_cast<void>(features::ComputePoint(c.p_C[k], model::Vec3::Zero(), point));
      const auto row = static_cast<Eigen::Index>(2 * k);
      feature_.s.segment<2>(row) = point.xy;
      feature_.L_s.middleRows<2>(row) = point.L;
    }
    control::VisualLaw(config_, camera_, feature_, {along_itself_, nowhere_, nowhere_}, law_);
    control::ResolveDamped(exact_, law_.task, motion_);
    c.V = motion_.dq;
  }

 private:
  config::LawConfig config_;
  control::DampingConfig exact_;
  model::ArmModel camera_;  // a free camera, without an arm
  const model::Mat6N along_itself_ = model::Mat6::Identity();
  const model::VecN nowhere_ = model::VecN::Zero(6);
  features::FeatureState feature_;
  control::VisualLawOutput law_;
  control::DampedMotion motion_;
};

// x = X / Z, y = Y / Z and the depth Z of each point.
VispPoints Seen(const Case& c) {
  VispPoints points;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const model::Vec3& p = c.p_C[k];
    points[k] = {p.x() / p.z(), p.y() / p.z(), p.z()};
  }
  return points;
}

void Keep(const VispTwist& V, Case& c) { c.V = Eigen::Map<const model::Vec6>(V.data()); }

VispPoints GoalPoints() {
  VispPoints points;
  for (std::size_t k = 0; k < kPoints; ++k) {
    points[k] = {kGoal[k][0], kGoal[k][1], kGoalDepth};
  }
  return points;
}

void CheckTwists(std::vector<Case>& cases, FoveaLaw& ours, VispLaw& theirs) {
  for (Case& c : cases) {
    ours.Compute(c);
    const model::Vec6 V = c.V;
    Keep(theirs.Control(Seen(c)), c);
    const model::Vec6 V_visp = c.V;
    Keep(theirs.Steps(Seen(c), kSmallestRatio), c);
    const double most = kSame * V.norm();
    if (!((V - V_visp).norm() <= most && (V - c.V).norm() <= most)) {
      throw std::runtime_error("the visual law's twist differs from ViSP's");
    }
  }
}

}  // namespace

std::vector<Figure> VispSpeed() {
  std::vector<Case> cases = RandomCases();
  FoveaLaw ours;
  VispLaw theirs(GoalPoints(), kLambda);
  CheckTwists(cases, ours, theirs);
  std::array<std::vector<double>, 3> means;
  for (int round = 0; round < kRounds; ++round) {
    means[0].push_back(MeanNs(cases, [&](Case& c) { ours.Compute(c); }));
    means[1].push_back(MeanNs(cases, [&](Case& c) { Keep(theirs.Steps(Seen(c), kSmallestRatio), c); }));
    means[2].push_back(MeanNs(cases, [&](Case& c) { Keep(theirs.Control(Seen(c)), c); }));
  }
  const double fovea = Percentile(means[0], 0.5);
  const double steps = Percentile(means[1], 0.5);
  const double control = Percentile(means[2], 0.5);
  return {{"fovea_law_ns", fovea, "ns", {}},
          {"visp_steps_ns", steps, "ns", {}},
          {"visp_control_law_ns", control, "ns", {}},
          {"visp_steps_ratio", steps / fovea, "", {}},
          {"visp_control_law_ratio", control / fovea, "", {}}};
}

}  // namespace fovea::bench
