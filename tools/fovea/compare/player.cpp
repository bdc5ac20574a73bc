// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/player.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "firmware/core/model/load.hpp"

namespace fovea::compare {
namespace {

constexpr double kT = hal::kTickPeriodS;
constexpr double kShift = 0.01;      // of the mass in `loaded_` [m]
constexpr double kRestSpeed = 0.02;  // Coulomb friction reaches its full size beyond this [rad/s, m/s]

model::VecN Torque(const model::ArmModel& arm, const model::ArmPoses& poses, const model::VecN& dq,
                   const model::VecN& ddq) {
  model::VecN tau(dq.size());
  model::InverseDynamics(arm, poses, dq, ddq, tau);
  return tau;
}

}  // namespace

Player::Player(const RecordedRun& run, const SimulatedArm& arm, int window_ticks, PlayerOutput output)
    : joints_(arm.robot.model.num_joints),
      window_ticks_(window_ticks),
      start_ns_(run.start_ns),
      output_(std::move(output)),
      arm_(arm.robot.model),
      through_window_(arm.world),
      through_tick_(arm.world) {
  for (int i = 0; i < 4; ++i) {
    model::ArmModel& loaded = loaded_[static_cast<std::size_t>(i)] = arm_;
    const model::Vec3 shift =
        i == 0 ? model::Vec3(model::Vec3::Zero()) : model::Vec3(kShift * model::Vec3::Unit(i - 1));
    model::Attach({1.0, arm.load_centre_E + shift, model::Mat3::Zero()}, loaded);
  }
  Restart();
}

double Player::Seconds(std::int64_t stamp_ns) const {
  return 1e-9 * static_cast<double>(stamp_ns - start_ns_);
}

void Player::Restart() {
  before_.reset();
  last_.reset();
  in_window_ = 0;
  late_.setZero(joints_);
  sums_[0].count = 0;
  sums_[1].count = -window_ticks_ / 2;
}

Player::Tick Player::TickOf(const hal::TickRecord& record) const {
  Tick tick;
  tick.record = record;
  tick.q = model::ToVector(record.arm.q, joints_);
  tick.dq = model::ToVector(record.arm.dq, joints_);
  model::ComputePoses(arm_, tick.q, tick.poses);
  model::ArmDynamics dynamics;
  model::ComputeDynamics(arm_, tick.poses, tick.dq, dynamics);
  tick.M = dynamics.M;
  tick.tau = model::ToVector(record.command.tau_cmd, joints_) + dynamics.g;
  return tick;
}

void Player::Add(const hal::TickRecord& record) {
  if (record.arm.num_joints != joints_ || record.command.num_joints != joints_) {
    Restart();
    return;
  }
  Tick tick = TickOf(record);
  if (!tick.q.allFinite() || !tick.dq.allFinite() || !tick.tau.allFinite()) {
    Restart();
    return;
  }
  if (last_ && (record.arm.stamp_ns != last_->record.arm.stamp_ns + hal::kTickPeriodNs ||
                last_->record.command.engage_brakes)) {
    Restart();
  }
  if (last_) {
    PlayWindow(*last_, tick);
    PlayTick(*last_, tick);
    ++played_;
  }
  before_ = std::move(last_);
  last_ = std::move(tick);
}

void Player::Step(const Tick& tick, sim::World& world) {
  world.Command(tick.record.command);
  world.AdvanceTo(world.now_ns() + hal::kTickPeriodNs);
}

void Player::PlayWindow(const Tick& from, const Tick& to) {
  if (in_window_ == 0) {
    through_window_.PlaceArm(from.q, from.dq);
  }
  Step(from, through_window_);
  in_window_ = (in_window_ + 1) % window_ticks_;
  output_.on_tick({Seconds(to.record.arm.stamp_ns), through_window_.Reading() - to.q,
                   through_window_.ReadingSpeed() - to.dq});
}

// An integrator shows a step's acceleration in the positions at the step's end, and one step later. Together
// they are the second difference that the simulated arm would have recorded.
void Player::PlayTick(const Tick& from, const Tick& to) {
  through_tick_.PlaceArm(from.q, from.dq);
  Step(from, through_tick_);
  const model::VecN moved = through_tick_.Reading() - from.q;
  const model::VecN predicted = (moved - kT * from.dq + late_) / (kT * kT);
  late_ = kT * through_tick_.ReadingSpeed() - moved;
  if (!before_) {
    return;
  }
  const model::VecN recorded = (to.q - 2.0 * from.q + before_->q) / (kT * kT);
  Lack lack;
  lack.ddq = predicted - recorded;
  lack.torque = -from.M * lack.ddq;
  lack.per_unit = PerUnit(*before_, from, recorded);
  const double t_s = Seconds(from.record.arm.stamp_ns);
  for (Sum& sum : sums_) {
    AddTo(sum, t_s, lack);
  }
}

Regressors Player::PerUnit(const Tick& before, const Tick& at, const model::VecN& ddq) const {
  Regressors per_unit(joints_, static_cast<int>(kUnknowns));
  per_unit.col(kCoulomb) = -(at.dq / kRestSpeed).array().tanh().matrix();
  per_unit.col(kViscous) = -at.dq;
  per_unit.col(kRotor) = -ddq;
  per_unit.col(kBias).setOnes();
  per_unit.col(kDelay) = -(at.tau - before.tau) / kT;
  const model::VecN none = Torque(arm_, at.poses, at.dq, ddq);
  const model::VecN mass = Torque(loaded_[0], at.poses, at.dq, ddq);
  per_unit.col(kMass) = none - mass;
  for (int i = 0; i < 3; ++i) {
    const model::VecN shifted = Torque(loaded_[static_cast<std::size_t>(i + 1)], at.poses, at.dq, ddq);
    per_unit.col(kMomentX + i) = (mass - shifted) / kShift;
  }
  return per_unit;
}

void Player::AddTo(Sum& sum, double t_s, const Lack& lack) {
  if (sum.count < 0) {
    ++sum.count;
    return;
  }
  if (sum.count == 0) {
    sum.lack = {t_s, model::VecN::Zero(joints_), model::VecN::Zero(joints_),
                Regressors::Zero(joints_, static_cast<int>(kUnknowns))};
  }
  const double turn = 2.0 * std::numbers::pi * (sum.count + 0.5) / window_ticks_;
  const double weight = (1.0 - std::cos(turn)) / window_ticks_;
  sum.lack.ddq += weight * lack.ddq;
  sum.lack.torque += weight * lack.torque;
  sum.lack.per_unit += weight * lack.per_unit;
  if (++sum.count == window_ticks_) {
    sum.lack.t_s = 0.5 * (sum.lack.t_s + t_s);
    output_.on_window(sum.lack);
    sum.count = 0;
  }
}

}  // namespace fovea::compare
