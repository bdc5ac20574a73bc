// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/eye_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "firmware/core/model/rotation.hpp"

namespace fovea::beliefs {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr std::size_t kFewestViews = 20;
constexpr std::int64_t kEndNs = 150'000'000;
constexpr int kMostSteps = 20;
constexpr double kMostDamping = 1e6;
constexpr double kSameView = 1e-3;  // the camera has hardly moved: less than 1 mm and 1 mrad together
// A detector states more than the noise of a view: errors that are the same in all views are in it too. So
// views agree with each other better than stated, but are not believed to be better than this share of it.
constexpr double kLeastMisfit = 0.6;

// A quantity: what it is called, its standard deviation before any data, and what counts as known.
struct Quantity {
  const char* name;
  const char* key;
  const char* unit;
  double per_unit;     // from SI
  double prior_sigma;  // SI
  double sigma_max;    // in `unit`
  double matters;      // in `unit`
};

// The priors are wide, but for the encoders' zeros: an arm leaves its maker with zeros good to a milliradian,
// and without this knowledge no mount could be told from them.
constexpr double kZeroSigma = 1e-3;
constexpr Quantity kLate{"latency", "camera.latency_ms", "ms", 1e3, 0.1, 5.0, 1.0};
constexpr Quantity kShift{"mount shift along", "camera.mount_xyz", "m", 1.0, 0.1, 0.005, 0.001};
constexpr Quantity kTurn{"mount turn about", "camera.mount_rpy_deg", "deg", kDegPerRad, 0.3, 0.5, 0.1};
constexpr Quantity kFocal{"focal length", "camera.f_u_px", "%", 100.0, 0.2, 1.0, 0.2};
constexpr Quantity kSize{"target size", "target.diameter", "%", 100.0, 0.2, 1.0, 0.2};
constexpr Quantity kZero{"encoder zero of joint", "", "deg", kDegPerRad, kZeroSigma, 0.05, 0.05};
constexpr double kTargetSigma = 1.0;  // [m, rad]

Belief MakeBelief(const Quantity& quantity, const std::string& which, const Marginal& marginal) {
  return {which.empty() ? quantity.name : fmt::format("{} {}", quantity.name, which),
          quantity.key,
          quantity.unit,
          quantity.per_unit * marginal.value,
          quantity.per_unit * marginal.sigma,
          quantity.sigma_max,
          quantity.matters};
}

Eigen::VectorXd PriorOf(const EyeLayout& layout) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(layout.size(), kTargetSigma);
  sigma[EyeLayout::kLate] = kLate.prior_sigma;
  sigma.segment<3>(EyeLayout::kShift).setConstant(kShift.prior_sigma);
  sigma.segment<3>(EyeLayout::kTurn).setConstant(kTurn.prior_sigma);
  sigma[EyeLayout::kFocal] = kFocal.prior_sigma;
  sigma[EyeLayout::kSize] = kSize.prior_sigma;
  sigma.segment(EyeLayout::kZeros, layout.zeros).setConstant(kZeroSigma);
  return sigma;
}

std::vector<Belief> BeliefsOf(const EyeLayout& layout, const Eigen::VectorXd& x, const Solution& solution,
                              const Eigen::VectorXd& prior_sigma, bool fits) {
  std::vector<Belief> beliefs;
  const auto add = [&](const Quantity& quantity, const std::string& which, int index) {
    Marginal marginal = WithoutPrior(x[index], solution.covariance(index, index), prior_sigma[index]);
    if (!fits) {
      marginal = {0.0, std::numeric_limits<double>::infinity()};
    }
    beliefs.push_back(MakeBelief(quantity, which, marginal));
  };
  const char* axes[] = {"the camera's x axis", "the camera's y axis", "the camera's z axis"};
  add(kLate, "", EyeLayout::kLate);
  for (int i = 0; i < 3; ++i) {
    add(kShift, axes[i], EyeLayout::kShift + i);
  }
  for (int i = 0; i < 3; ++i) {
    add(kTurn, axes[i], EyeLayout::kTurn + i);
  }
  add(kFocal, "", EyeLayout::kFocal);
  add(kSize, "", EyeLayout::kSize);
  for (int i = 0; i < layout.zeros; ++i) {
    add(kZero, fmt::format("{}", i + 2), EyeLayout::kZeros + i);
  }
  return beliefs;
}

double WayBetween(const model::Pose& a, const model::Pose& b) {
  return (a.p - b.p).norm() + model::RotationVector(a.R.transpose() * b.R).norm();
}

}  // namespace

void EyeEstimator::Add(const hal::TickRecord& record) {
  track_.Add(record.arm.stamp_ns, model::ToVector(record.arm.q, config_.arm.num_joints));
  if (record.target_known) {
    const auto& p = record.p_BO;
    model::Pose X_BO;
    X_BO.p = {p[0], p[1], p[2]};
    if (model::RotationOfQuaternion(record.q_BO, X_BO.R)) {
      X_BO_ = X_BO;
    }
  }
  if (!record.has_feature || !record.feature.found) {
    return;
  }
  if (config_.predict.row_time > 0.0) {
    return;  // the rows' times would pass for a latency: nothing is known
  }
  while (!views_.empty() && views_.front().measurement.stamp_ns < track_.first_ns()) {
    views_.pop_front();
  }
  View view{record.feature, {}};
  EyePose eye;
  if (!PoseOfEye(config_, track_, Believed(config_, {}), view.measurement.stamp_ns, eye)) {
    return;
  }
  view.X_BC = eye.X_BC;
  if (views_.empty() || WayBetween(views_.back().X_BC, view.X_BC) > kSameView) {
    views_.push_back(view);
  }
}

// The target's pose to begin with: a ball's or disc's mean place by the believed calibration.
std::optional<model::Pose> EyeEstimator::FirstGuess() const {
  if (config_.feature.SeesOrientation()) {
    return X_BO_;
  }
  model::Pose X_BO;
  int count = 0;
  for (const View& view : views_) {
    if (features::LiftedTarget lifted; config_.feature.Lift(view.measurement, lifted)) {
      X_BO.p += view.X_BC * lifted.p_CO_C;
      ++count;
    }
  }
  X_BO.p /= std::max(count, 1);
  return count > 0 ? std::optional(X_BO) : std::nullopt;
}

// The measured corner that is O's first: with it, the view fits best.
int EyeEstimator::TurnOf(const View& view, const EyeState& state) const {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < config_.feature.corners.num_corners; ++turn) {
    Equations equations;
    if (Compare(config_, track_, view.measurement, turn, state, equations) &&
        equations.residual.norm() < least) {
      least = equations.residual.norm();
      best = turn;
    }
  }
  return best;
}

// The equations of all views at `state`. Leaves out views that are impossible there, and those so near to an
// end of the track that their readings would be missing with another latency.
std::vector<Equations> EyeEstimator::CompareAll(const std::vector<int>& turns, const EyeState& state) const {
  std::vector<Equations> blocks;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const std::int64_t stamp_ns = views_[i].measurement.stamp_ns;
    Equations equations;
    if (stamp_ns >= track_.first_ns() + kEndNs && stamp_ns <= track_.last_ns() - kEndNs &&
        Compare(config_, track_, views_[i].measurement, turns[i], state, equations)) {
      blocks.push_back(std::move(equations));
    }
  }
  return blocks;
}

EyeEstimate EyeEstimator::Estimate() const {
  EyeEstimate estimate;
  const EyeLayout layout(config_);
  const Eigen::VectorXd prior_sigma = PriorOf(layout);
  const std::optional<model::Pose> X_BO = views_.size() < kFewestViews ? std::nullopt : FirstGuess();
  estimate.state = Believed(config_, X_BO.value_or(model::Pose{}));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(layout.size());
  Solution solution = Solve({}, x, prior_sigma);
  std::vector<int> turns;
  std::vector<Equations> blocks;
  if (X_BO) {
    for (const View& view : views_) {
      turns.push_back(layout.is_flat ? TurnOf(view, estimate.state) : 0);
    }
    blocks = CompareAll(turns, estimate.state);
  }
  for (int step = 0; step < kMostSteps && blocks.size() >= kFewestViews; ++step) {
    solution = Solve(blocks, x, prior_sigma, kLeastMisfit);
    estimate.views = static_cast<int>(blocks.size());
    estimate.misfit = solution.misfit;
    const Eigen::VectorXd sigma = solution.covariance.diagonal().cwiseSqrt();
    if (solution.change.cwiseQuotient(sigma).cwiseAbs().maxCoeff() < 1e-2) {
      break;
    }
    // Far along what the views hardly tell, the equations are not linear: such steps are shortened until they
    // help.
    const double cost = CostOf(blocks, x, prior_sigma, solution.misfit);
    bool better = false;
    for (double damping = 0.0; !better && damping <= kMostDamping; damping = 10.0 * damping + 1.0) {
      const Eigen::VectorXd change = solution.DampedChange(damping, prior_sigma);
      EyeState candidate = estimate.state;
      Apply(layout, change, candidate);
      std::vector<Equations> there = CompareAll(turns, candidate);
      better =
          there.size() >= blocks.size() && CostOf(there, x + change, prior_sigma, solution.misfit) < cost;
      if (better) {
        x += change;
        estimate.state = candidate;
        blocks = std::move(there);
      }
    }
    if (!better) {
      break;
    }
  }
  estimate.beliefs = BeliefsOf(layout, x, solution, prior_sigma, estimate.Fits());
  return estimate;
}

}  // namespace fovea::beliefs
