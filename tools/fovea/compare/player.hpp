// SPDX-License-Identifier: Apache-2.0
// Plays a log's commands into the simulator's arm, and tells where the recorded arm moved otherwise.
//
// Open loop, the two drift apart, so the simulated arm starts anew from the recorded state: at the begin of
// each window for the differences of positions and velocities, and in each tick for those of accelerations.
// The recorded acceleration of one tick is mostly noise. So it is averaged over a window with the weight of
// Hann, 1 - cos: then the second derivative falls on the weight, and only positions enter
// (Shinbrot, On the analysis of linear and nonlinear systems, 1957). Velocities that a robot filters, late,
// do not. The difference times the arm's mass matrix is the torque that the simulated arm lacks.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "firmware/core/model/dynamics.hpp"
#include "fovea/hal/record.hpp"
#include "sim/world/world.hpp"
#include "tools/fovea/compare/simulated_arm.hpp"

namespace fovea::compare {

// Torque on a joint per unit of each thing that may be wrong with the simulated arm.
enum Unknown : int {
  kCoulomb,  // friction [Nm, N]
  kViscous,  // friction [Nm s/rad, N s/m]
  kRotor,    // inertia of the rotor [kg m^2, kg]
  kBias,     // of the torque [Nm, N]
  kMass,     // at the hand, where the load is believed to be [kg]
  kMomentX,  // mass times distance from there, in E [kg m]
  kMomentY,
  kMomentZ,
  kDelay,  // of all torques [s]
  kUnknowns
};
inline constexpr int kOfOneJoint = kMass;  // the unknowns before it are each joint's own

using Regressors = Eigen::Matrix<double, Eigen::Dynamic, kUnknowns, Eigen::RowMajor, model::kMaxJoints>;

// Of one tick of a window: predicted less recorded.
struct Deviation {
  double t_s = 0.0;  // since the first state
  model::VecN q;
  model::VecN dq;
};

// Weighted means over a window.
struct Lack {
  double t_s = 0.0;     // the window's middle
  model::VecN ddq;      // predicted less recorded [rad/s^2, m/s^2]
  model::VecN torque;   // that the recorded arm had beyond the simulated one [Nm, N]
  Regressors per_unit;  // torques per unit of each unknown
};

struct PlayerOutput {
  std::function<void(const Deviation&)> on_tick;
  std::function<void(const Lack&)> on_window;
};

class Player {
 public:
  // `window_ticks`: even. Windows of Lack overlap by half.
  Player(const RecordedRun& run, const SimulatedArm& arm, int window_ticks, PlayerOutput output);

  // A tick's record, in their order. A gap, a state that is not new, brakes, or another number of joints
  // ends the windows.
  void Add(const hal::TickRecord& record);

  [[nodiscard]] int ticks() const { return played_; }

 private:
  struct Tick {
    hal::TickRecord record;
    model::VecN q;
    model::VecN dq;
    model::ArmPoses poses;
    model::MatN M;
    model::VecN tau;  // of the motors: the command, and the weight that the robot itself compensates
  };
  // A window that is being filled.
  struct Sum {
    int count = 0;  // below 0: it begins later
    Lack lack;
  };

  void Restart();
  void PlayWindow(const Tick& from, const Tick& to);
  void PlayTick(const Tick& from, const Tick& to);
  [[nodiscard]] Tick TickOf(const hal::TickRecord& record) const;
  [[nodiscard]] Regressors PerUnit(const Tick& before, const Tick& at, const model::VecN& ddq) const;
  void AddTo(Sum& sum, double t_s, const Lack& lack);
  // Steps `world` by one tick under `tick`'s command.
  static void Step(const Tick& tick, sim::World& world);
  [[nodiscard]] double Seconds(std::int64_t stamp_ns) const;

  const int joints_;
  const int window_ticks_;
  const std::int64_t start_ns_;
  const PlayerOutput output_;
  const model::ArmModel arm_;
  std::array<model::ArmModel, 4> loaded_;  // with 1 kg more, and with it elsewhere
  sim::World through_window_;
  sim::World through_tick_;
  std::optional<Tick> before_;
  std::optional<Tick> last_;
  model::VecN
      late_;  // part of the last tick's predicted second difference that shows one tick later [rad, m]
  int in_window_ = 0;  // ticks that through_window_ has played
  int played_ = 0;
  std::array<Sum, 2> sums_;
};

}  // namespace fovea::compare
