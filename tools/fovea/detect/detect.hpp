// fovea detect: the detector on anyone's pictures.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "firmware/vision/detect/detector_config.hpp"

namespace fovea {

struct DetectArguments {
  std::vector<std::string> images;
  std::string target;  // by its name
  std::string method;  // empty: by colour when a hue is given, else gray
  double hue_deg = -1.0;
  std::string camera_file;
  double focal_px = 0.0;  // 0: a field of 60 degrees
  double size = 0.0;      // [m]; 0: unknown, then any distance will do
  double radius_min_px = 8.0;
  double radius_max_px = 0.0;  // 0: what fits into the image
  double confidence_min = 0.5;
  vision::HoughConfig hough;
  std::string marked;  // folder for pictures with what was found drawn in; empty: none
  bool json = false;
};

CLI::App* AddDetect(CLI::App& app, DetectArguments& arguments);

// Prints what was seen, image by image; returns the program's exit code. Throws config::InputError.
int Detect(const DetectArguments& arguments);

}  // namespace fovea
