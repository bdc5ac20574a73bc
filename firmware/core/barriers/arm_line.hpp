// The arm as a line: from the base through each joint to the end effector.
//
// A link whose next joint is to the side as well as along does not go there straight: its line has a corner
// where the side step ends (X_L * (x, 0, 0), with x the next joint's place along the link's own x axis; in
// Denavit and Hartenberg's frames that is the common normal's end). The arm's thickness about the line is for
// those who ask how near it comes to something.
#pragma once

#include <array>

#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

struct ArmLine {
  static constexpr int kMaxPoints = 2 * model::kMaxJoints + 2;

  int num_points = 0;
  std::array<model::Vec3, kMaxPoints> p_B;  // in B [m]
  std::array<int, kMaxPoints> joint;  // whose link carries the point and the line to the next; -1: the base
};

// The last joints: the elbow's, and the wrist's three. What they carry is the forearm and the hand.
inline constexpr int kForearmJoints = 4;

// Real-time: yes.
[[nodiscard]] ArmLine LineOfArm(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
