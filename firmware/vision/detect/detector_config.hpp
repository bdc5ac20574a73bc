// What is looked for, and how.
#pragma once

#include "firmware/core/features/target_feature.hpp"
#include "firmware/vision/find/colour_model.hpp"
#include "firmware/vision/pose/intrinsics.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::vision {

enum class FindBy {
  kColour,  // edges of what has the target's colour
  kGray,    // edges of brightness, whatever the colour
  kHough,   // the source's finder: blur, Hough transform for circles; sphere and disc alone
};

// The source's finder, on the gray image: GaussianBlur and HoughCircles as OpenCV has them.
struct HoughConfig {
  double blur_sigma_px = 1.5;
  double canny_threshold = 100.0;
  double votes = 30.0;
  double resolution_px = 1.0;  // of the votes' places
  double spacing_px = 30.0;    // between circles' middles
};

// What no picture of a camera tells of itself, and the covariance allows for.
struct EdgeNoise {
  double floor = 0.3;       // of a picture's noise: less is not believed [gray levels, standard deviation]
  double shift_px = 0.01;   // what lens and light may move an outline or a side as a whole
  double corner_px = 0.06;  // what the pixels' grid and colours may move a corner, otherwise in each picture
};

struct DetectorConfig {
  hal::FeatureKind kind = hal::FeatureKind::kSphere;
  Intrinsics intrinsics;
  FindBy by = FindBy::kColour;
  ColourConfig colour;
  HoughConfig hough;
  EdgeNoise edge_noise;
  double size = 0.08;          // a ball's and a disc's diameter [m]
  features::Polygon corners;   // a plate's: about their mean, turning from x to y
  double distance_min = 0.12;  // a target can only be this near [m]
  double distance_max = 1.20;  // or this far [m]: smaller things are something else
  double radius_min_px = 8.0;  // nor are smaller outlines looked for: radius of the circle with their area
  double radius_max_px = 400.0;
  double confidence_min = 0.5;  // finds below it are refused, 0 to 1

  void LookFor(const features::TargetFeature& target) {
    kind = target.target;
    size = 2.0 * target.radius;
    corners = target.corners;
  }
};

}  // namespace fovea::vision
