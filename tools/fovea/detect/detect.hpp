// SPDX-License-Identifier: Apache-2.0
// fovea detect: runs the detector on any images.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/vision/detector_config.hpp"

namespace fovea {

struct DetectArguments {
  std::vector<std::string> images;
  std::string target;  // name of the target
  std::string method;  // empty: by colour when a hue is given, else gray
  double hue_deg = -1.0;
  std::string camera_file;
  std::optional<double> focal_px;  // none: a field of view of 60 degrees
  double size = 0.0;               // [m]; 0: unknown
  double radius_min_px = 8.0;
  double radius_max_px = 0.0;  // 0: 0.75 of the larger side of the image
  double confidence_min = 0.5;
  vision::HoughConfig hough;
  std::string marked;  // folder for copies with the detection drawn in; empty: none
  bool json = false;
};

CLI::App* AddDetect(CLI::App& app, DetectArguments& arguments);

// Prints the detection in each image; returns the program's exit code. Throws config::InputError.
int Detect(const DetectArguments& arguments);

}  // namespace fovea
