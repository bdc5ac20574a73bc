// SPDX-License-Identifier: Apache-2.0
// Which target the detector searches for, and how.
#pragma once

#include "firmware/core/features/target_feature.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::vision {

enum class FindBy {
  kColour,  // edges of regions with the target's colour
  kGray,    // edges of brightness, for a target of any colour
  kHough,   // the course exercises' finder: blur, Hough transform for circles; only sphere and disc
};

struct ColourConfig {
  double hue_deg = 0.0;          // of the target; 0 is red, 120 green, 240 blue
  double hue_width_deg = 12.0;   // standard deviation of the hue
  double saturation_min = 0.35;  // a colour below it has likeness 0; 0 to 1
};

// The course exercises' finder, on the gray image: OpenCV's GaussianBlur and HoughCircles.
struct HoughConfig {
  double blur_sigma_px = 1.5;
  double canny_threshold = 100.0;
  double votes = 30.0;
  double resolution_px = 1.0;  // of the votes: size of an accumulator cell
  double spacing_px = 30.0;    // least distance between circle centres
};

// Errors that a picture does not show. The covariance includes them. Standard deviations.
struct EdgeNoise {
  double floor = 0.3;       // least noise assumed for a picture [gray levels]
  double shift_px = 0.01;   // common shift of an outline or a side by lens and light
  double corner_px = 0.06;  // shift of a corner by pixel grid and colours, independent in each picture
};

struct DetectorConfig {
  hal::FeatureKind kind = hal::FeatureKind::kSphere;
  Intrinsics intrinsics;
  FindBy by = FindBy::kColour;
  ColourConfig colour;
  HoughConfig hough;
  EdgeNoise edge_noise;
  double size = 0.08;          // diameter of a sphere or disc [m]
  features::Polygon corners;   // of a plate: relative to their mean, in the rotational sense from x to y
  double distance_min = 0.12;  // least distance of a target [m]
  double distance_max = 1.20;  // greatest distance of a target [m]; a smaller outline is another object
  double radius_min_px = 8.0;  // least size of an outline: radius of the circle with its area
  double radius_max_px = 400.0;
  double confidence_min = 0.5;  // detections below it are rejected, 0 to 1

  void LookFor(const features::TargetFeature& target) {
    kind = target.target;
    size = 2.0 * target.radius;
    corners = target.corners;
  }
};

}  // namespace fovea::vision
