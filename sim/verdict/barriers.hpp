// What must hold in a run, by the simulator's truth: one list, each entry with a name and a value.
//
// To judge something more, add a line to the list in verdict_barriers.cpp: what it is called, of what kind it
// is (LimitBook::Kind), and how its value follows from a step.
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
  double workspace_radius = 0.85;  // [m]
  double cartesian_speed = 1.7;    // of the hand [m/s]
  double rotation_speed = 2.5;     // and of its turn [rad/s]
  config::Obstacles obstacles;     // that the hand keeps out of
  config::HandShape hand;          // what moves with it, beside its point
};

// A step of physics as the barriers see it.
struct TruthStep {
  const Truth& now;
  const Truth* before = nullptr;  // a step earlier; none at the start
  // Joint accelerations: the mean over the last 10 ms, and those of this step and of the one before. Empty
  // where the servo was in Fault within that time.
  std::optional<Eigen::VectorXd> mean_ddq;
  Eigen::VectorXd mean_ddq_disturbed;  // what of it disturbances alone did; no entries: nothing
  Eigen::VectorXd rebound;  // and what of it may be the springing back of what they did before; as above
  std::optional<Eigen::VectorXd> ddq;
  std::optional<Eigen::VectorXd> ddq_before;
};

struct TruthBarrier {
  std::string name;
  LimitBook::Kind kind;
  std::function<std::optional<double>(const TruthStep&)> value;  // none: it does not apply to this step
};

// The list.
std::vector<TruthBarrier> MakeTruthBarriers(const BarrierConfig& config);

// Notes all of them, step by step. One thread uses it.
class TruthBarriers {
 public:
  explicit TruthBarriers(const BarrierConfig& config);

  // In order, one for each step of 1 ms. `mode`: the servo's, whose command was in force in this step.
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
  std::vector<Eigen::VectorXd> ddq_disturbed_;  // and what disturbances did in them
  Eigen::VectorXd rebound_;                     // of those that are over, fading; no entries: there was none
  std::optional<Truth> before_;
};

}  // namespace fovea::sim
