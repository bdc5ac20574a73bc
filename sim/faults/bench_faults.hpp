// What goes wrong with the arm itself; physics (World) does as it says.
#pragma once

#include <Eigen/Core>

#include "sim/faults/time_window.hpp"

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
  double mass = 0.0;  // [kg]; 0: there is none
};

// The arm's base leans by `tilt` about its own x: the weight pulls aside, and the robot's controller
// compensates for it as if the base stood upright.
struct BaseTilt {
  TimeWindow window;
  double tilt = 0.0;  // [rad]
};

}  // namespace fovea::sim
