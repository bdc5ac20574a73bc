// SPDX-License-Identifier: Apache-2.0
// Faults of the bench: the arm's body and the camera's outage. World applies them.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "fovea/hal/types.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

// External torques on the joints.
struct JointPush {
  Eigen::VectorXd tau;  // [num_dofs] torques [Nm, N]; empty: none
  TimeWindow window;
};

// A motor that delivers less torque, both of the command and of the robot controller's own part. The arm
// still reports the full command as active.
struct TorqueLoss {
  TimeWindow window;
  int joint = 0;
  double share = 1.0;
};

// A mass at the end effector's frame, unknown to the robot's controller and to the servo. It has the hand's
// velocity when it is attached.
struct Load {
  TimeWindow window;
  double mass = 1.0;  // [kg]
};

// The arm's base is tilted by `tilt` about its x axis. The robot's controller still compensates gravity as if
// the base were upright.
struct BaseTilt {
  TimeWindow window;
  double tilt = 5.0 * std::numbers::pi / 180.0;  // [rad]
};

struct BenchFaults {
  TimeWindow camera_outage;  // the camera delivers nothing
  TorqueLoss torque_loss;
  Load load;
  BaseTilt base_tilt;
  JointPush push;
};

template <class Visitor, Struct<BenchFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  v.Window({"camera_outage", "s", "the camera delivers nothing"}, f.camera_outage);
  v.Window({"torque_loss", "s", "a joint's motor delivers less torque, of the command and against gravity"},
           f.torque_loss.window);
  v.Joint({"torque_loss_joint", "", "joint with the weak motor, counted from 1"}, f.torque_loss.joint,
          f.torque_loss.window, 1);
  v.Number({"torque_loss", "", "lost share of the torque"}, f.torque_loss.share, 0.0, 1.0);
  v.Window({"load", "s", "a mass hangs at the end effector, unknown to robot and servo"}, f.load.window);
  v.Number({"load_mass", "kg", "mass of this load"}, f.load.mass, 0.0, 100.0);
  v.Window(
      {"gravity", "s", "the arm's base is tilted; the robot's own gravity compensation ignores the tilt"},
      f.base_tilt.window);
  v.Scaled({"gravity_tilt_deg", "deg", "tilt about the base's x axis"}, f.base_tilt.tilt,
           std::numbers::pi / 180.0, -180.0, 180.0);
  v.Window({"push", "s", "external torques act on the joints"}, f.push.window);
  v.List({"push", "Nm", "these torques, one per joint; default: none"}, f.push.tau, hal::kMaxJoints, -1e4,
         1e4);
}

}  // namespace fovea::sim
