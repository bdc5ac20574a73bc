// One provocation for each row of firmware/GUARDS.md; guard_table_test.cpp walks the rows.
#pragma once

namespace fovea::test {

// Limits: named in time, nothing passed, the arm stands in the end.
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

// Faults: latched in time, the arm stops and stays.
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
