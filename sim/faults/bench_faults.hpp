// What goes wrong with the arm itself; physics (World) does as it says.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "fovea/hal/types.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

// Something that pulls at the joints for a while.
struct JointPush {
  Eigen::VectorXd tau;  // [num_dofs] torques [Nm, N]; empty: nothing does
  TimeWindow window;
};

// A motor that gives less than it should, of the command and of what its own controller adds; the arm reports
// the command as in force all the same.
struct TorqueLoss {
  TimeWindow window;
  int joint = 0;
  double share = 1.0;
};

// A mass at the end effector's frame that nobody told the robot's controller or the servo of. It has the
// hand's velocity when it is taken up.
struct Load {
  TimeWindow window;
  double mass = 1.0;  // [kg]
};

// The arm's base leans by `tilt` about its own x: the weight pulls aside, and the robot's controller
// compensates for it as if the base stood upright.
struct BaseTilt {
  TimeWindow window;
  double tilt = 5.0 * std::numbers::pi / 180.0;  // [rad]
};

struct BenchFaults {
  TimeWindow camera_outage;  // in which the camera delivers nothing
  TorqueLoss torque_loss;
  Load load;
  BaseTilt base_tilt;
  JointPush push;
};

template <class Visitor, Struct<BenchFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  v.Window({"camera_outage", "s", "the camera delivers nothing from the first time to the second"},
           f.camera_outage);
  v.Window(
      {"torque_loss", "s", "a joint's motor gives less than it should, of the command and against gravity"},
      f.torque_loss.window);
  v.Joint({"torque_loss_joint", "", "which joint's, counted from 1"}, f.torque_loss.joint,
          f.torque_loss.window, 1);
  v.Number({"torque_loss", "", "share that does not arrive"}, f.torque_loss.share, 0.0, 1.0);
  v.Window({"load", "s", "a mass hangs at the end effector that nobody was told of"}, f.load.window);
  v.Number({"load_mass", "kg", "its mass"}, f.load.mass, 0.0, 100.0);
  v.Window(
      {"gravity", "s", "the arm's base leans, and the robot's own compensation of its weight does not know"},
      f.base_tilt.window);
  v.Scaled({"gravity_tilt_deg", "deg", "by so much, about the base's x"}, f.base_tilt.tilt,
           std::numbers::pi / 180.0, -180.0, 180.0);
  v.List(
      {"push", "Nm", "torques that push the joints from outside, one per joint; nothing does when not given"},
      f.push.tau, hal::kMaxJoints, -1e4, 1e4);
  v.Window({"push", "s", "from the first time to the second"}, f.push.window);
}

}  // namespace fovea::sim
