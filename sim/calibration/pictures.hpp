// Pictures to calibrate the simulated camera with: a board on the bench from many sides, with the hand's
// poses, and a disc from two distances. The arm is placed, not driven: what a calibration needs is where it
// stood.
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
  std::vector<std::string> boards;  // the pictures in `out`, in order; poses.csv says where the hand was
  std::vector<std::string> discs;   // in `out`, the nearer one first
  double disc_diameter = 0.08;      // [m]
  double disc_delta_z = 0.15;       // between the two [m]
};

// Writes the pictures, poses.csv, and truth.json: what a calibration shall find. InputError: a scenario
// without an eye, a board that does not lie on the bench, an arm that does not come to enough places.
CalibrationPictures TakeCalibrationPictures(const Scenario& scenario,
                                            const CalibrationPicturesOptions& options);

}  // namespace fovea::sim
