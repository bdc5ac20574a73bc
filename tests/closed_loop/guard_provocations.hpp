// SPDX-License-Identifier: Apache-2.0
// One provocation for each row of firmware/GUARDS.md; guard_table_test.cpp runs them all.
#pragma once

namespace fovea::test {

// Limits: reported in time, never exceeded, the arm stands at the end.
void ProvokeJointPosition();
void ProvokeJointVelocity();
void ProvokeJointAcceleration();
void ProvokeJointJerk();
void ProvokeWorkspace();
void ProvokeTorque();
void ProvokeTorqueRate();
void ProvokeObstacle();
void ProvokeCartesianSpeed();
void ProvokeSingularity();
void ProvokeFieldOfView();
void ProvokeRotationSpeed();

// Faults: latched in time, the arm stops and stays at rest.
void ProvokeArmLost();
void ProvokeArmStale();
void ProvokeNonFiniteSensor();
void ProvokeNonFiniteFeature();
void ProvokeNonFiniteControl();
void ProvokeDeadlineMissed();
void ProvokeJointOutside();
void ProvokeJointTooFast();
void ProvokeNotFollowing();
void ProvokeContact();

}  // namespace fovea::test
