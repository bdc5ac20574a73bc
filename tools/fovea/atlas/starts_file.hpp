// SPDX-License-Identifier: Apache-2.0
// The starts of --starts: a CSV file with a heading, or JSON (an array of objects, one per line or all in
// one).
//
// A start has either the arm's posture (q1, q2, ... [rad, m]) or the camera's pose in B (camera_x, camera_y,
// camera_z [m], camera_roll, camera_pitch, camera_yaw [deg]); the target's pose in B (target_x, ... as the
// camera's); optionally its own goal (goal_x, ... as the keys servo.goal and servo.goal_rpy_deg), and the
// seed of its run (seed).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/fovea/atlas/sampler.hpp"

namespace fovea::atlas {

// InputError, with file, line, column and what is allowed: the file cannot be read, has other columns or
// values, a start from which no run can begin, or a goal that the simulator refuses.
std::vector<Start> ReadStarts(const std::filesystem::path& file, const Scene& scene);

// Tells apart the contents of two files. InputError: the file cannot be read.
std::string HashOfFile(const std::filesystem::path& file);

}  // namespace fovea::atlas
