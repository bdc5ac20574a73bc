// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/arm_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/host/beliefs/least_squares.hpp"

namespace fovea::beliefs {
namespace {

constexpr int kPartTicks = 10;     // between two evaluations of the dynamics
constexpr int kWindowTicks = 100;  // over which torques are averaged
constexpr std::size_t kMostWindows = 600;
constexpr std::size_t kFewestWindows = 20;
constexpr double kSlow = 0.05;  // below this speed a joint's friction has no clear direction [rad/s, m/s]

// Standard deviations before any data. The arm's own masses and torque sensors are known to these.
constexpr double kLoadSigma = 5.0;           // [kg]
constexpr double kMomentSigma = 0.5;         // [kg m]
constexpr double kLinkMassSigma = 0.01;      // relative
constexpr double kBiasShare = 0.002;         // of a joint's largest torque
constexpr double kNoiseShare = 1e-4;         // of a joint's largest torque: least error of a window's mean
constexpr double kFrictionSigmaShare = 1.0;  // of a joint's largest torque, per rad/s for viscous friction

constexpr int kFewestPasses = 3;  // for the errors of the windows
constexpr int kMostPasses = 12;
constexpr double kSurprise = 1.5;  // the few errors that windows determine are smaller than this by chance
constexpr double kSurer = 1.02;    // a size that grows by less is the last one

// How large the arm's own errors are, as a multiple of `stated` (1 or more): their squares, over the number
// of them that the windows determine. `prior`: with what the covariance was computed. (MacKay, Bayesian
// interpolation, 1992.)
double SizeOf(const Eigen::VectorXd& x, const Eigen::VectorXd& variance, const Eigen::VectorXd& prior,
              const Eigen::VectorXd& stated) {
  const double determined = (1.0 - variance.array() / prior.array().square()).sum();
  const double squares = (x.array() / stated.array()).square().sum();
  return std::sqrt(std::max(squares / std::max(determined, 1.0), 1.0));
}

model::VecN Hold(const model::ArmDynamics& d) { return d.Cdq + d.g; }

// Mean torque of a motion between two samples that are `seconds` apart: M ddq + C dq + g.
model::VecN MeanTorque(const model::ArmDynamics& begin, const model::VecN& dq_begin,
                       const model::ArmDynamics& end, const model::VecN& dq_end, double seconds) {
  return 0.5 * ((begin.M + end.M) * (dq_end - dq_begin) / seconds + Hold(begin) + Hold(end));
}

// The arm as its torque sensors on the side of the links see it.
config::ServoConfig WithoutRotors(config::ServoConfig config) {
  for (model::Joint& joint : config.arm.joints) {
    joint.rotor_inertia = 0.0;
  }
  return config;
}

model::VecN RotorInertias(const model::ArmModel& arm) {
  model::VecN inertias(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    inertias[i] = arm.joints[static_cast<std::size_t>(i)].rotor_inertia;
  }
  return inertias;
}

}  // namespace

ArmEstimator::ArmEstimator(const config::ServoConfig& config, const model::Load& load)
    : config_(WithoutRotors(config)), rotor_inertia_(RotorInertias(config.arm)), load_(load) {
  // A point mass at the believed centre, and shifts of it. The difference of two places has no moment of
  // inertia of its own to first order.
  constexpr double kShift = 0.01;
  const auto with_mass = [&](double mass, const model::Vec3& p_E) {
    model::ArmModel arm = config_.arm;
    model::Attach({mass, p_E, model::Mat3::Zero()}, arm);
    return arm;
  };
  arms_.push_back(with_mass(1.0, load.p_ECom));
  steps_.push_back(1.0);
  for (int i = 0; i < 3; ++i) {
    arms_.push_back(with_mass(1.0, load.p_ECom + kShift * model::Vec3::Unit(i)));
    steps_.push_back(kShift);
  }
  for (int i = 0; i < config_.arm.num_joints; ++i) {
    model::ArmModel arm = config_.arm;
    model::LinkInertia& link = arm.links[static_cast<std::size_t>(i)];
    link.mass *= 2.0;
    link.I_Com_Li *= 2.0;
    arms_.push_back(arm);
    steps_.push_back(1.0);
  }
}

ArmEstimator::Sample ArmEstimator::Evaluate(const hal::TickRecord& record) const {
  const int n = config_.arm.num_joints;
  const model::VecN q = model::ToVector(record.arm.q, n);
  Sample sample;
  sample.dq = model::ToVector(record.arm.dq, n);
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, q, poses);
  model::ComputeDynamics(config_.arm, poses, sample.dq, sample.believed);
  for (const model::ArmModel& arm : arms_) {
    model::ComputeDynamics(arm, poses, sample.dq, sample.unknown.emplace_back());
  }
  return sample;
}

ArmEstimator::Torques ArmEstimator::TorquesOf(const hal::TickRecord& record) const {
  const int n = config_.arm.num_joints;
  return {model::ToVector(record.arm.tau_meas, n), model::ToVector(record.arm.tau_applied, n)};
}

void ArmEstimator::Begin(const hal::TickRecord& record) {
  const int n = config_.arm.num_joints;
  open_ = true;
  ticks_ = 0;
  sample_ = Evaluate(record);
  torques_ = TorquesOf(record);
  window_.torque.setZero(n);
  window_.regressors.setZero(n, static_cast<Eigen::Index>(arms_.size()));
  window_.friction.setZero(n);
  window_.dq.setZero(n);
  window_.dq_least = sample_.dq;
}

void ArmEstimator::AddPart(const Sample& begin, const Sample& end) {
  const double seconds = kPartTicks * hal::kTickPeriodS;
  const double share = static_cast<double>(kPartTicks) / kWindowTicks;
  const model::VecN believed = MeanTorque(begin.believed, begin.dq, end.believed, end.dq, seconds);
  window_.torque -= share * believed;
  window_.friction += 0.5 * share * (begin.believed.g + end.believed.g);
  window_.friction -= share / seconds * rotor_inertia_.cwiseProduct(end.dq - begin.dq);
  model::VecN of_mass;
  for (std::size_t k = 0; k < arms_.size(); ++k) {
    model::VecN torque = MeanTorque(begin.unknown[k], begin.dq, end.unknown[k], end.dq, seconds) - believed;
    if (k == 0) {
      of_mass = torque;
    } else if (k < kLoads) {
      torque -= of_mass;
    }
    window_.regressors.col(static_cast<Eigen::Index>(k)) += share / steps_[k] * torque;
  }
}

void ArmEstimator::Add(const hal::TickRecord& record) {
  const int n = config_.arm.num_joints;
  const bool follows = open_ && record.arm.stamp_ns == stamp_ns_ + hal::kTickPeriodNs;
  const bool counts = !record.command.engage_brakes && record.arm.num_joints == n;
  stamp_ns_ = record.arm.stamp_ns;
  if (!follows || !counts) {
    open_ = false;
    if (counts) {
      Begin(record);
    }
    return;
  }
  const model::VecN dq = model::ToVector(record.arm.dq, n);
  const Torques now = TorquesOf(record);
  window_.torque += 0.5 * (torques_.link + now.link) / kWindowTicks;
  window_.friction += 0.5 * (torques_.motor - torques_.link + now.motor - now.link) / kWindowTicks;
  window_.dq += dq / kWindowTicks;
  torques_ = now;
  for (int i = 0; i < n; ++i) {
    double& least = window_.dq_least[i];
    least = least * dq[i] <= 0.0 ? 0.0 : std::copysign(std::min(std::fabs(least), std::fabs(dq[i])), least);
  }
  if (++ticks_ % kPartTicks != 0) {
    return;
  }
  const Sample end = Evaluate(record);
  AddPart(sample_, end);
  sample_ = end;
  if (ticks_ == kWindowTicks) {
    windows_.push_back(window_);
    if (windows_.size() > kMostWindows) {
      windows_.pop_front();
    }
    Begin(record);
  }
}

void ArmEstimator::EstimateLoad(ArmEstimate& estimate) const {
  const int n = config_.arm.num_joints;
  const auto unknowns = static_cast<Eigen::Index>(arms_.size());
  Eigen::VectorXd prior = Eigen::VectorXd::Constant(unknowns + n, kLinkMassSigma);
  prior[0] = kLoadSigma;
  prior.segment<3>(1).setConstant(kMomentSigma);
  Eigen::VectorXd sigma(n);  // of a window's torques
  Eigen::VectorXd least(n);
  for (int i = 0; i < n; ++i) {
    const double tau_max = config_.arm.joints[static_cast<std::size_t>(i)].tau_max;
    prior[unknowns + i] = kBiasShare * tau_max;
    sigma[i] = kBiasShare * tau_max;
    least[i] = kNoiseShare * tau_max;
  }
  const Eigen::Index own = unknowns + n - kLoads;  // link masses and torque biases
  const Eigen::VectorXd stated = prior.tail(own);
  double size = 1.0;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns + n);
  Solution solution;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    std::vector<Equations> blocks;
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(n);
    for (const Window& window : windows_) {
      Equations block;
      block.jacobian.resize(n, unknowns + n);
      block.jacobian << -window.regressors, -Eigen::MatrixXd::Identity(n, n);
      block.residual = window.torque + block.jacobian * x;
      squares += block.residual.cwiseAbs2();
      blocks.push_back(std::move(block));
    }
    if (pass > 0) {
      sigma = (squares / static_cast<double>(windows_.size())).cwiseSqrt().cwiseMax(least);
    }
    for (Equations& block : blocks) {
      block.residual = block.residual.cwiseQuotient(sigma);
      block.jacobian = sigma.cwiseInverse().asDiagonal() * block.jacobian;
    }
    solution = Solve(blocks, x, prior, 1.0);
    x += solution.change;
    if (pass + 1 < kFewestPasses) {
      continue;
    }
    const double now = SizeOf(x.tail(own), solution.covariance.diagonal().tail(own), prior.tail(own), stated);
    if (now < (size > 1.0 ? kSurer * size : kSurprise)) {
      break;
    }
    size = now;
    prior.tail(own) = size * stated;
  }
  const Marginal mass = WithoutPrior(x[0], solution.covariance(0, 0), prior[0]);
  estimate.beliefs.push_back({"load", "arm.load_mass", "kg", mass.value, mass.sigma, 0.1, 0.02});
  const double total = std::max(load_.mass + mass.value, 0.0);
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const Marginal moment = WithoutPrior(x[1 + i], solution.covariance(1 + i, 1 + i), prior[1 + i]);
    const bool known = total > 3.0 * mass.sigma;  // else there is no load to have a centre
    estimate.beliefs.push_back({fmt::format("centre of the load along the hand's {} axis", axes[i]),
                                "arm.load_com", "m", known ? moment.value / total : 0.0,
                                known ? moment.sigma / total : std::numeric_limits<double>::infinity(), 0.02,
                                0.005});
  }
}

void ArmEstimator::EstimateFriction(int joint, ArmEstimate& estimate) const {
  const double tau_max = config_.arm.joints[static_cast<std::size_t>(joint)].tau_max;
  Eigen::VectorXd prior = Eigen::VectorXd::Constant(3, kFrictionSigmaShare * tau_max);
  std::vector<Equations> blocks;
  for (const Window& window : windows_) {
    if (std::fabs(window.dq_least[joint]) < kSlow) {
      continue;
    }
    Equations block;
    block.jacobian.resize(1, 3);
    block.jacobian << -window.dq[joint], -std::copysign(1.0, window.dq[joint]), -1.0;
    block.residual = Eigen::VectorXd::Constant(1, window.friction[joint]);
    blocks.push_back(std::move(block));
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(3);
  Solution solution = Solve({}, x, prior);
  for (int pass = 0; pass < 3 && blocks.size() >= 5; ++pass) {
    std::vector<Equations> now = blocks;
    for (Equations& block : now) {
      block.residual += block.jacobian * x;
    }
    solution = Solve(now, x, prior, kNoiseShare * tau_max);
    x += solution.change;
  }
  const model::Joint& believed = config_.arm.joints[static_cast<std::size_t>(joint)];
  const char* forms[] = {"viscous", "Coulomb"};
  const char* units[] = {"Nm s/rad", "Nm"};
  const double most[] = {believed.viscous, believed.coulomb};
  for (int i = 0; i < 2; ++i) {
    const Marginal marginal = WithoutPrior(x[i], solution.covariance(i, i), prior[i]);
    estimate.beliefs.push_back({fmt::format("{} friction left in joint {}", forms[i], joint + 1),
                                i == 0 ? "arm.viscous" : "arm.coulomb", units[i], marginal.value,
                                marginal.sigma, 0.005 * tau_max, most[i] + 0.01 * tau_max});
  }
}

ArmEstimate ArmEstimator::Estimate() const {
  ArmEstimate estimate;
  if (windows_.size() < kFewestWindows) {
    return estimate;
  }
  estimate.windows = static_cast<int>(windows_.size());
  EstimateLoad(estimate);
  for (int i = 0; i < config_.arm.num_joints; ++i) {
    EstimateFriction(i, estimate);
  }
  return estimate;
}

}  // namespace fovea::beliefs
