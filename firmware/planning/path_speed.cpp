// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/path_speed.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::planning {
namespace {

constexpr double kHandShare = 0.90;     // of the hand's speed limit
constexpr double kTurnShare = 0.85;     // of the hand's turn limit
constexpr double kBarrierShare = 0.95;  // of the speed towards a barrier
constexpr double kCrawl = 0.02;         // a barrier slows the fastest joint to this at most [rad/s, m/s]
constexpr int kHalvings = 40;
constexpr int kSlowKnots = 4;  // on each side of a place that is slowed down

// The largest s = du/dt at `posture` for the direction `slope`.
double CapAt(const PostureSpace& space, const Posture& posture, const model::VecN& slope,
             const JointLimits& joints) noexcept {
  const config::ServoConfig& config = space.config();
  double s = HUGE_VAL;
  for (int i = 0; i < slope.size(); ++i) {
    s = std::min(s, joints[static_cast<std::size_t>(i)].v_max / std::fabs(slope[i]));
  }
  model::LinearJacobian J_E_B;
  model::ComputeLinearJacobian(config.arm, posture.poses, posture.poses.X_BE.p, J_E_B);
  s = std::min(s, kHandShare * config::SpeedLimitOfReference(config.guard) / J_E_B.lazyProduct(slope).norm());
  s = std::min(s, kTurnShare * config::TurnLimitOfReference(config.guard) /
                      model::AngularVelocity(config.arm, posture.poses, slope).norm());
  barriers::MotionLimits limits;
  space.LimitsAt(posture, s * slope, limits);
  const double crawl = std::min(s, kCrawl / slope.lpNorm<Eigen::Infinity>());
  for (int i = 0; i < slope.size(); ++i) {
    const double bound = slope[i] > 0.0 ? limits.dq_max[i] : limits.dq_min[i];
    s = slope[i] == 0.0 ? s : std::min(s, kBarrierShare * bound / slope[i]);
  }
  for (int k = 0; k < limits.num_rows; ++k) {
    const barriers::LimitRow& row = limits.rows[static_cast<std::size_t>(k)];
    const double towards = row.a.dot(slope);
    s = towards > 0.0 ? std::min(s, kBarrierShare * row.b / towards) : s;
  }
  return std::max(s, crawl);
}

// The range of d2u/dt2 that keeps low <= a + b d2u/dt2 <= high.
struct Interval {
  double low = -HUGE_VAL;
  double high = HUGE_VAL;

  void Keep(double a, double b, double most) noexcept {
    if (b == 0.0) {
      if (std::fabs(a) > most) {
        high = -HUGE_VAL;
      }
      return;
    }
    const double one = (-most - a) / b;
    const double other = (most - a) / b;
    low = std::max(low, std::min(one, other));
    high = std::min(high, std::max(one, other));
  }
};

}  // namespace

PathSpeed::PathSpeed(const JointLimits& limits, int most_corners) : limits_(limits) {
  knots_.reserve(static_cast<std::size_t>(kCellsInPiece * most_corners));
  bends_.reserve(static_cast<std::size_t>(kCellsInPiece * most_corners));
}

void PathSpeed::Begin(const PostureSpace& space, const SmoothPath& path, Work& work) noexcept {
  knots_.clear();
  bends_.clear();
  const std::size_t cells = kCellsInPiece * static_cast<std::size_t>(path.End());
  Posture posture;
  for (std::size_t k = 0; k <= cells; ++k) {
    Knot knot;
    knot.u = static_cast<double>(k) / kCellsInPiece;
    knot.slope = path.Slope(knot.u);
    space.Place(path.At(knot.u), work, posture);
    const double s = CapAt(space, posture, knot.slope, limits_);
    knot.x_cap = s * s;
    knots_.push_back(knot);
    if (k < cells) {
      bends_.push_back(path.Bend(knot.u + 0.5 / kCellsInPiece));
    }
  }
  // A joint's speed in a cell is at most that of the larger q' with the larger x.
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    for (const std::size_t beside : {k > 0 ? k - 1 : k, std::min(k + 1, cells)}) {
      for (Eigen::Index i = 0; i < knots_[k].slope.size(); ++i) {
        const double s = limits_[static_cast<std::size_t>(i)].v_max / std::fabs(knots_[beside].slope[i]);
        knots_[k].x_cap = std::min(knots_[k].x_cap, s * s);
      }
    }
  }
  knots_.front().x_cap = 0.0;
  knots_.back().x_cap = 0.0;
}

double PathSpeed::MostAfter(std::size_t cell, double x_begin, double x_end_most) const noexcept {
  const Knot& begin = knots_[cell];
  const Knot& end = knots_[cell + 1];
  const double twice = 2.0 * (end.u - begin.u);
  Interval ddu{-x_begin / twice, (x_end_most - x_begin) / twice};
  for (Eigen::Index i = 0; i < begin.slope.size(); ++i) {
    const double bend = bends_[cell][i];
    const double most = limits_[static_cast<std::size_t>(i)].a_max;
    ddu.Keep(bend * x_begin, begin.slope[i], most);
    ddu.Keep(bend * x_begin, end.slope[i] + twice * bend, most);
  }
  return ddu.low <= ddu.high ? std::max(x_begin + twice * ddu.high, 0.0) : -1.0;
}

double PathSpeed::MostBefore(std::size_t cell, double x_end_most) const noexcept {
  double low = 0.0;
  double high = knots_[cell].x_cap;
  if (MostAfter(cell, high, x_end_most) >= 0.0) {
    return high;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (MostAfter(cell, middle, x_end_most) >= 0.0 ? low : high) = middle;
  }
  return low;
}

double PathSpeed::Run() noexcept {
  for (std::size_t k = knots_.size() - 1; k > 0; --k) {
    knots_[k].x = k + 1 == knots_.size() ? 0.0 : MostBefore(k, knots_[k + 1].x);
  }
  knots_.front().x = 0.0;
  knots_.front().t = 0.0;
  for (std::size_t k = 0; k + 1 < knots_.size(); ++k) {
    Knot& end = knots_[k + 1];
    end.x = std::max(MostAfter(k, knots_[k].x, end.x), 0.0);
    const double speeds = std::sqrt(knots_[k].x) + std::sqrt(end.x);
    if (!(speeds > 0.0)) {
      return HUGE_VAL;
    }
    end.t = knots_[k].t + 2.0 * (end.u - knots_[k].u) / speeds;
  }
  return knots_.back().t;
}

void PathSpeed::SlowDown(double u, double share) noexcept {
  const int middle = static_cast<int>(u * kCellsInPiece);
  const int last = static_cast<int>(knots_.size()) - 1;
  for (int k = std::max(middle - kSlowKnots, 1); k <= std::min(middle + 1 + kSlowKnots, last - 1); ++k) {
    Knot& knot = knots_[static_cast<std::size_t>(k)];
    knot.x_cap = std::min(knot.x_cap, share * share * knot.x);
  }
}

double PathSpeed::UAt(double t, std::size_t& cell) const noexcept {
  if (t <= 0.0) {
    return knots_.front().u;
  }
  while (cell + 1 < knots_.size() && t >= knots_[cell + 1].t) {
    ++cell;
  }
  if (cell + 1 >= knots_.size()) {
    return knots_.back().u;
  }
  const Knot& begin = knots_[cell];
  const Knot& end = knots_[cell + 1];
  const double after = t - begin.t;
  const double ddu = (end.x - begin.x) / (2.0 * (end.u - begin.u));
  return std::min(begin.u + after * (std::sqrt(begin.x) + 0.5 * after * ddu), end.u);
}

}  // namespace fovea::planning
