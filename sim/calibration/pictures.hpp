// SPDX-License-Identifier: Apache-2.0
// Renders pictures for the calibration of the simulated camera: a board on the bench from many sides, with
// the hand's poses, and a disc from two distances. The arm is placed without motion: only its poses matter.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/calibration/board.hpp"
#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

struct CalibrationPicturesOptions {
  calibration::Board board;
  int views = 14;
  std::filesystem::path out;
};

struct CalibrationPictures {
  std::vector<std::string> boards;  // pictures of the board in `out`, in the order of poses.csv
  std::vector<std::string> discs;   // pictures of the disc in `out`, the nearer one first
  double disc_diameter = 0.08;      // [m]
  double disc_delta_z = 0.15;       // distance between the two camera positions [m]
};

// Writes the pictures, poses.csv and truth.json (the true values that a calibration must find). InputError:
// the scenario has no camera, the board does not fit on the bench, or the arm cannot reach enough views.
CalibrationPictures TakeCalibrationPictures(const Scenario& scenario,
                                            const CalibrationPicturesOptions& options);

}  // namespace fovea::sim
