// SPDX-License-Identifier: Apache-2.0
// The conditions that a run must satisfy by the simulator's truth: one list of names and values.
//
// To add a condition, add an entry to the list in barriers.cpp: its name, its kind (LimitBook::Kind), and how
// its value follows from a step.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/arm_model.hpp"
#include "fovea/hal/events.hpp"
#include "sim/verdict/limit_book.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

struct BarrierConfig {
  model::ArmModel arm;
  double workspace_radius = 0.85;          // [m]
  double cartesian_speed = 1.7;            // of the hand [m/s]
  double rotation_speed = 2.5;             // of the hand [rad/s]
  config::Obstacles obstacles;             // that the hand must avoid
  config::HandShape hand;                  // camera and tools that move with the hand
  std::vector<Eigen::AlignedBox3d> boxes;  // that truly stand on the bench
};

// One step of the physics, input of the barriers.
struct TruthStep {
  const Truth& now;
  const Truth* before = nullptr;  // the previous step; null at the start
  // Joint accelerations: the mean over the last 10 ms, that of this step, and that of the previous one. Empty
  // if the servo was in Fault within the last 10 ms.
  std::optional<Eigen::VectorXd> mean_ddq;
  Eigen::VectorXd mean_ddq_disturbed;  // its part caused by disturbances; size 0: none
  Eigen::VectorXd rebound;             // its possible part due to past disturbances; size 0: none
  std::optional<Eigen::VectorXd> ddq;
  std::optional<Eigen::VectorXd> ddq_before;
};

struct TruthBarrier {
  std::string name;
  LimitBook::Kind kind;
  std::function<std::optional<double>(const TruthStep&)> value;  // none if it does not apply to this step
};

// The list of all conditions.
std::vector<TruthBarrier> MakeTruthBarriers(const BarrierConfig& config);

// Evaluates all conditions, step by step. Only one thread may use it.
class TruthBarriers {
 public:
  explicit TruthBarriers(const BarrierConfig& config);

  // Call it in order, once per step of 1 ms. `mode`: mode of the servo that commanded this step.
  void Add(const Truth& truth, hal::Mode mode);
  [[nodiscard]] const LimitBook& book() const { return book_; }

 private:
  struct Listed {
    TruthBarrier barrier;
    std::size_t entry = 0;
  };
  static constexpr std::size_t kMeanTicks = 10;

  std::vector<Listed> list_;
  LimitBook book_;
  std::vector<Eigen::VectorXd> dq_;             // of the last steps outside Fault, newest last
  std::vector<Eigen::VectorXd> ddq_disturbed_;  // effect of disturbances in these steps
  Eigen::VectorXd rebound_;                     // decaying effect of past disturbances; size 0: none
  std::optional<Truth> before_;
};

}  // namespace fovea::sim
