// SPDX-License-Identifier: Apache-2.0
// fovea calibrate: focal length, intrinsics with lens, and the camera's pose on the hand.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "firmware/host/calibration/calibration.hpp"
#include "firmware/host/config/board_flags.hpp"

namespace fovea {

struct CalibrateArguments {
  double diameter = 0.0;  // focal
  double delta_z = 0.0;
  std::vector<std::string> images;
  std::string target = "circle";
  std::string folder;  // intrinsics, hand-eye
  config::BoardFlags board_flags;
  calibration::Board board;  // made from board_flags
  std::string camera_file;
  std::string log;  // from-log
  std::string out;
  std::string write;  // a configuration to write the result into; empty: none
  bool json = false;
};

// Adds the subcommand, which has five subcommands itself.
CLI::App* AddCalibrate(CLI::App& app, CalibrateArguments& arguments);

// Runs the given one of them; returns the program's exit code. Throws config::InputError.
int Calibrate(const CLI::App& calibrate, CalibrateArguments& arguments);

}  // namespace fovea
