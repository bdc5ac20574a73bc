// fovea detect: the detector on anyone's pictures.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/vision/detect/detector_config.hpp"

namespace fovea {

inline const std::map<std::string, hal::FeatureKind> kTargetKinds = [] {
  std::map<std::string, hal::FeatureKind> kinds;
  for (const features::TargetTraits& target : features::kTargets) {
    kinds[target.name] = target.kind;
  }
  return kinds;
}();

struct DetectArguments {
  std::vector<std::string> images;
  hal::FeatureKind target = hal::FeatureKind::kSphere;
  std::string method;  // empty: by colour when a hue is given, else gray
  double hue_deg = -1.0;
  std::string camera_file;
  double focal_px = 0.0;  // 0: a field of 60 degrees
  double size = 0.0;      // [m]; 0: unknown, then any distance will do
  double radius_min_px = 8.0;
  double radius_max_px = 0.0;  // 0: what fits into the image
  double confidence_min = 0.5;
  vision::HoughConfig hough;
  bool json = false;
};

CLI::App* AddDetect(CLI::App& app, DetectArguments& arguments);

// Prints what was seen, image by image; returns the program's exit code. Throws config::InputError.
int Detect(const DetectArguments& arguments);

}  // namespace fovea
