// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/causes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

namespace fovea::compare {
namespace {

constexpr double kFloorShare = 2e-4;  // of a joint's largest torque: least error of a window's torque
constexpr int kData = kUnknowns;      // column of the torques themselves

// Sums of products of a joint's regressors and torques.
using Gram = Eigen::Matrix<double, kUnknowns + 1, kUnknowns + 1>;

// Standard deviations of the unknowns before any data: far larger than what can be.
constexpr std::array<double, kUnknowns> kPrior{1e3, 1e3, 1e2, 1e3, 1e2, 1e1, 1e1, 1e1, 1.0};

// A cause in one joint, or in all.
struct Part {
  Cause cause = Cause::kFriction;
  int joint = -1;  // -1: of all joints together
  bool operator<(const Part& other) const {
    return cause != other.cause ? cause < other.cause : joint < other.joint;
  }
};

std::vector<Unknown> UnknownsOf(Cause cause) {
  switch (cause) {
    case Cause::kFriction: return {kCoulomb, kViscous};
    case Cause::kRotor: return {kRotor};
    case Cause::kBias: return {kBias};
    case Cause::kLoad: return {kMass, kMomentX, kMomentY, kMomentZ};
    case Cause::kDelay: break;
  }
  return {kDelay};
}

class Search {
 public:
  Search(const std::vector<Lack>& windows, const std::vector<double>& tau_max)
      : joints_(static_cast<int>(tau_max.size())), grams_(tau_max.size(), Gram::Zero()) {
    for (const Lack& window : windows) {
      for (int i = 0; i < joints_; ++i) {
        Eigen::Matrix<double, kUnknowns + 1, 1> row;
        row << window.per_unit.row(i).transpose(), window.torque[i];
        grams_[static_cast<std::size_t>(i)] += row * row.transpose();
      }
    }
    samples_ = static_cast<double>(windows.size());
    SetAccuracies(tau_max);
  }

  Causes Find() {
    std::set<Part> parts;
    double cost = Cost(parts);
    for (bool changed = true; changed;) {
      changed = Grow(parts, cost);
      changed = Shrink(parts, cost) || changed;
    }
    return Results(parts);
  }

 private:
  // Where an unknown of a joint is among all unknowns.
  [[nodiscard]] int IndexOf(Unknown unknown, int joint) const {
    return unknown < kOfOneJoint ? kOfOneJoint * joint + unknown
                                 : kOfOneJoint * joints_ + (unknown - kOfOneJoint);
  }
  [[nodiscard]] int Size() const { return IndexOf(kUnknowns, 0); }

  // The accuracy of each joint's torques: what all causes together leave.
  void SetAccuracies(const std::vector<double>& tau_max) {
    floor_.resize(joints_);
    for (int i = 0; i < joints_; ++i) {
      floor_[i] = kFloorShare * tau_max[static_cast<std::size_t>(i)];
    }
    sigma_ = floor_;
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd x = Fit(All());
      for (int i = 0; i < joints_; ++i) {
        sigma_[i] = std::max(floor_[i], std::sqrt(std::max(Squares(i, x), 0.0) / samples_));
      }
    }
  }

  [[nodiscard]] std::set<Part> All() const {
    std::set<Part> parts{{Cause::kLoad, -1}, {Cause::kDelay, -1}};
    for (int i = 0; i < joints_; ++i) {
      for (const Cause cause : {Cause::kFriction, Cause::kRotor, Cause::kBias}) {
        parts.insert({cause, i});
      }
    }
    return parts;
  }

  [[nodiscard]] std::vector<int> Indices(const std::set<Part>& parts) const {
    std::vector<int> indices;
    for (const Part& part : parts) {
      for (const Unknown unknown : UnknownsOf(part.cause)) {
        indices.push_back(IndexOf(unknown, std::max(part.joint, 0)));
      }
    }
    return indices;
  }

  // Least squares of the unknowns of `parts`; the others are 0.
  [[nodiscard]] Eigen::VectorXd Fit(const std::set<Part>& parts) const {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(Size(), Size());
    Eigen::VectorXd b = Eigen::VectorXd::Zero(Size());
    for (int i = 0; i < joints_; ++i) {
      const Gram gram = grams_[static_cast<std::size_t>(i)] / (sigma_[i] * sigma_[i]);
      for (int k = 0; k < kUnknowns; ++k) {
        const int at = IndexOf(static_cast<Unknown>(k), i);
        A(at, at) += 1.0 / (kPrior[static_cast<std::size_t>(k)] * kPrior[static_cast<std::size_t>(k)]);
        b[at] += gram(k, kData);
        for (int m = 0; m < kUnknowns; ++m) {
          A(at, IndexOf(static_cast<Unknown>(m), i)) += gram(k, m);
        }
      }
    }
    const std::vector<int> used = Indices(parts);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(Size());
    const Eigen::MatrixXd A_used = A(used, used);
    const Eigen::VectorXd b_used = b(used);
    const Eigen::VectorXd x_used = A_used.ldlt().solve(b_used);
    x(used) = x_used;
    return x;
  }

  // The unknowns of joint `i`.
  [[nodiscard]] Eigen::Matrix<double, kUnknowns, 1> Of(int i, const Eigen::VectorXd& x) const {
    Eigen::Matrix<double, kUnknowns, 1> own;
    for (int k = 0; k < kUnknowns; ++k) {
      own[k] = x[IndexOf(static_cast<Unknown>(k), i)];
    }
    return own;
  }

  // Sum of squares of joint `i` that `x` leaves.
  [[nodiscard]] double Squares(int i, const Eigen::VectorXd& x) const {
    Eigen::Matrix<double, kUnknowns + 1, 1> left;
    left << -Of(i, x), 1.0;
    return left.dot(grams_[static_cast<std::size_t>(i)] * left);
  }

  // Schwarz's criterion; the windows overlap by half.
  [[nodiscard]] double Cost(const std::set<Part>& parts) const {
    const Eigen::VectorXd x = Fit(parts);
    double cost =
        std::log(std::max(0.5 * samples_ * joints_, 3.0)) * static_cast<double>(Indices(parts).size());
    for (int i = 0; i < joints_; ++i) {
      cost += 0.5 * Squares(i, x) / (sigma_[i] * sigma_[i]);
    }
    return cost;
  }

  // Adds the cause that lowers the cost most.
  bool Grow(std::set<Part>& parts, double& cost) const {
    std::vector<std::set<Part>> candidates;
    const std::set<Part> all = All();
    for (const Part& part : all) {
      candidates.push_back(parts);
      candidates.back().insert(part);
    }
    for (const Cause cause : {Cause::kFriction, Cause::kRotor, Cause::kBias}) {
      candidates.push_back(parts);
      for (int i = 0; i < joints_; ++i) {
        candidates.back().insert({cause, i});
      }
    }
    return TakeBest(candidates, parts, cost);
  }

  // Leaves out the cause without which the cost is least.
  bool Shrink(std::set<Part>& parts, double& cost) const {
    bool changed = false;
    for (bool again = true; again; changed = changed || again) {
      std::vector<std::set<Part>> candidates;
      for (const Part& part : parts) {
        candidates.push_back(parts);
        candidates.back().erase(part);
      }
      again = TakeBest(candidates, parts, cost);
    }
    return changed;
  }

  bool TakeBest(const std::vector<std::set<Part>>& candidates, std::set<Part>& parts, double& cost) const {
    constexpr double kLeastGain = 1.0;
    bool better = false;
    double best = cost - kLeastGain;
    std::set<Part> chosen;
    for (const std::set<Part>& candidate : candidates) {
      if (const double now = Cost(candidate); now < best) {
        best = now;
        chosen = candidate;
        better = true;
      }
    }
    if (better) {
      parts = chosen;
      cost = best;
    }
    return better;
  }

  [[nodiscard]] Causes Results(const std::set<Part>& parts) const {
    const Eigen::VectorXd x = Fit(parts);
    Causes causes;
    for (int i = 0; i < joints_; ++i) {
      const Gram& gram = grams_[static_cast<std::size_t>(i)];
      const Eigen::Matrix<double, kUnknowns, 1> own = Of(i, x);
      JointCauses joint;
      for (int c = 0; c < kCauses && gram(kData, kData) > 0.0; ++c) {
        double product = 0.0;  // of the torques with the part that the cause explains
        for (const Unknown unknown : UnknownsOf(static_cast<Cause>(c))) {
          product += own[unknown] * gram(unknown, kData);
        }
        joint.share[static_cast<std::size_t>(c)] = std::clamp(product / gram(kData, kData), 0.0, 1.0);
      }
      joint.coulomb = own[kCoulomb];
      joint.viscous = own[kViscous];
      joint.rotor = own[kRotor];
      joint.bias = own[kBias];
      causes.joints.push_back(joint);
      causes.mass = own[kMass];
      causes.moment = own.segment<3>(kMomentX);
      causes.delay_s = own[kDelay];
    }
    return causes;
  }

  const int joints_;
  double samples_ = 0.0;     // windows
  std::vector<Gram> grams_;  // of each joint
  Eigen::VectorXd floor_;    // least accuracy [Nm, N]
  Eigen::VectorXd sigma_;    // accuracy of each joint's torques [Nm, N]
};

}  // namespace

Causes FindCauses(const std::vector<Lack>& windows, const std::vector<double>& tau_max) {
  return Search(windows, tau_max).Find();
}

model::VecN Explained(const Causes& causes, const Lack& window) {
  model::VecN torque(window.torque.size());
  for (int i = 0; i < torque.size(); ++i) {
    const JointCauses& joint = causes.joints[static_cast<std::size_t>(i)];
    Eigen::Matrix<double, kUnknowns, 1> unknowns;
    unknowns << joint.coulomb, joint.viscous, joint.rotor, joint.bias, causes.mass, causes.moment,
        causes.delay_s;
    torque[i] = window.per_unit.row(i).dot(unknowns);
  }
  return torque;
}

}  // namespace fovea::compare
