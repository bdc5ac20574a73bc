// SPDX-License-Identifier: Apache-2.0
// An adversarial camera. Its measurements of a ball freeze, repeat, go the wrong way, jump, run away from the
// hand or lure it to forbidden places. The seed decides which trick follows and how long it lasts.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <random>

#include "fovea/hal/feature.hpp"

namespace fovea::test {

enum class Trick {
  kHonest,     // the true position, with noise
  kFrozen,     // the position when the trick began
  kSame,       // as kFrozen, and the measurement reports an unchanged picture
  kReplayed,   // the position some time ago
  kMirrored,   // left and right swapped
  kTurned,     // turned by up to 1.2 rad, as by a wrong mount
  kWalks,      // a random walk in C
  kRunsAway,   // at constant velocity in B, up to 4 m/s
  kFlees,      // fixed in C beside where it was seen: it moves along with the camera
  kDrawsDown,  // at least 0.6 m below the camera, so that the hand goes down
  kDrawsHome,  // 0.1 m from the base's origin
  kJumps,      // to another place every fourth frame
  kNoise,      // 0.3 m of noise in each frame
  kHuge,       // scaled by 1e-12 to 1e12
};
inline constexpr int kNumTricks = 14;

class Adversary {
 public:
  explicit Adversary(std::uint64_t seed) : random_(seed) {}

  // The measurement of a ball of `radius` [m] at `p_BO` [m], exposed at `stamp_ns` from `X_BC`; true or not.
  hal::FeatureMeasurement See(const Eigen::Isometry3d& X_BC, const Eigen::Vector3d& p_BO, double radius,
                              std::int64_t stamp_ns) {
    if (frames_left_-- <= 0) {
      Begin(stamp_ns);
    }
    const Eigen::Vector3d honest = X_BC.inverse() * p_BO;
    seen_.push_back(honest);
    if (seen_.size() > 60) {
      seen_.pop_front();
    }
    if (!started_) {
      started_ = true;
      p_C_ = honest;
      p_B_ = p_BO;
    }
    Eigen::Vector3d p = Place(X_BC, honest);
    p.z() = std::max(std::fabs(p.z()), 0.05);  // in front of the camera, or the servo refuses it at once
    hal::FeatureMeasurement m;
    m.stamp_ns = stamp_ns + stamp_off_ns_;
    m.sequence = sequence_++;
    m.same_for_ns = trick_ == Trick::kSame ? stamp_ns - since_ns_ : 0;
    m.found = Uniform(0.0, 1.0) > missing_;
    m.confidence = 1.0;
    m.dim = 3;
    for (int i = 0; i < 3; ++i) {
      m.s[static_cast<std::size_t>(i)] = p[i] / radius + Normal() * sigma_;
      m.cov_s[static_cast<std::size_t>(i * hal::kMaxFeatureDim + i)] = claimed_ * claimed_;
    }
    return m;
  }

  [[nodiscard]] Trick trick() const { return trick_; }
  // How often each trick was played.
  [[nodiscard]] const std::array<int, kNumTricks>& played() const { return played_; }

 private:
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double Normal() { return normal_(random_); }
  Eigen::Vector3d Anywhere(double size) { return size * Eigen::Vector3d(Normal(), Normal(), Normal()); }

  void Begin(std::int64_t stamp_ns) {
    // Every other trick is kHonest, so that the servo tracks again and can be misled again.
    trick_ = trick_ == Trick::kHonest
                 ? static_cast<Trick>(1 + static_cast<int>(Uniform(0.0, kNumTricks - 1.001)))
                 : Trick::kHonest;
    ++played_[static_cast<std::size_t>(trick_)];
    frames_left_ = static_cast<int>(std::exp(Uniform(std::log(3.0), std::log(240.0))));
    since_ns_ = stamp_ns;
    started_ = false;
    speed_ = Uniform(0.0, 1.0) < 0.5 ? Uniform(0.05, 0.5) : Uniform(0.5, 4.0);
    way_ = Anywhere(1.0).normalized();
    delay_ = static_cast<std::size_t>(Uniform(1.0, 59.0));
    turn_ = Eigen::AngleAxisd(Uniform(-1.2, 1.2), Anywhere(1.0).normalized());
    const bool honest = trick_ == Trick::kHonest;
    sigma_ = honest ? 1e-3 : std::pow(10.0, Uniform(-5.0, -1.0));
    claimed_ = honest ? 1e-3 : std::pow(10.0, Uniform(-4.0, -1.0));
    missing_ = honest || Uniform(0.0, 1.0) < 0.7 ? 0.0 : Uniform(0.0, 0.8);
    stamp_off_ns_ =
        honest || Uniform(0.0, 1.0) < 0.7 ? 0 : static_cast<std::int64_t>(Uniform(-0.2, 0.06) * 1e9);
  }

  Eigen::Vector3d Place(const Eigen::Isometry3d& X_BC, const Eigen::Vector3d& honest) {
    constexpr double kFrameS = 1.0 / 30.0;
    switch (trick_) {
      case Trick::kHonest: return honest;
      case Trick::kFrozen:
      case Trick::kSame: return p_C_;
      case Trick::kReplayed: return seen_[seen_.size() > delay_ ? seen_.size() - 1 - delay_ : 0];
      case Trick::kMirrored: return {-honest.x(), honest.y(), honest.z()};
      case Trick::kTurned: return turn_ * honest;
      case Trick::kWalks: p_C_ += Anywhere(0.2 * speed_ * kFrameS); return p_C_;
      case Trick::kRunsAway: p_B_ += speed_ * kFrameS * way_; return X_BC.inverse() * p_B_;
      case Trick::kFlees: return p_C_ + 0.05 * speed_ * way_;
      case Trick::kDrawsDown:
        return X_BC.inverse() * (X_BC.translation() - Eigen::Vector3d(0.0, 0.0, 0.6 + speed_));
      case Trick::kDrawsHome: return X_BC.inverse() * (0.1 * way_);
      case Trick::kJumps:
        if (frames_left_ % 4 == 0) {
          p_C_ = honest + Anywhere(0.2);
        }
        return p_C_;
      case Trick::kNoise: return honest + Anywhere(0.3);
      case Trick::kHuge: return honest * std::pow(10.0, Uniform(-12.0, 12.0));
    }
    return honest;
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  Trick trick_ = Trick::kRunsAway;
  std::array<int, kNumTricks> played_{};
  int frames_left_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t since_ns_ = 0;
  bool started_ = false;
  std::deque<Eigen::Vector3d> seen_;  // true positions in C
  Eigen::Vector3d p_C_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_B_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d way_ = Eigen::Vector3d::UnitX();
  Eigen::AngleAxisd turn_{0.0, Eigen::Vector3d::UnitX()};
  std::size_t delay_ = 1;
  double speed_ = 0.1;
  double sigma_ = 1e-3;
  double claimed_ = 1e-3;
  double missing_ = 0.0;
  std::int64_t stamp_off_ns_ = 0;
};

}  // namespace fovea::test
