// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/vision_keys.hpp"

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {

void AddVisionKeys(VisionSettings& settings, KeyTable& keys) {
  vision::DetectorConfig& c = settings.config;
  keys.Choice("vision.method", settings.method, {"colour", "gray", "hough"},
              "colour: search by the target's colour; gray: search by brightness only; hough: the "
              "finder of the course exercises, Gaussian blur and Hough transform");
  keys.Number("vision.hue_deg", c.colour.hue_deg, 0.0, 360.0, "deg",
              "the target's hue: 0 red, 120 green, 240 blue");
  keys.Number("vision.hue_width_deg", c.colour.hue_width_deg, 1.0, 90.0, "deg",
              "standard deviation of the target's hue");
  keys.Number("vision.saturation_min", c.colour.saturation_min, 0.0, 1.0, "",
              "least saturation of the target's colour");
  keys.Number("vision.hough_blur_sigma_px", c.hough.blur_sigma_px, 0.1, 10.0, "px",
              "method \"hough\": Gaussian blur of the gray image");
  keys.Number("vision.hough_canny_threshold", c.hough.canny_threshold, 1.0, 1000.0, "",
              "method \"hough\": Canny threshold of the edges that vote");
  keys.Number("vision.hough_votes", c.hough.votes, 1.0, 1000.0, "",
              "method \"hough\": least number of votes for a circle");
  keys.Number("vision.hough_resolution_px", c.hough.resolution_px, 0.5, 8.0, "px",
              "method \"hough\": cell size of the accumulator of votes");
  keys.Number("vision.hough_spacing_px", c.hough.spacing_px, 1.0, 1000.0, "px",
              "method \"hough\": least distance between two circles");
  keys.Renamed("vision.blur_sigma_px", "vision.hough_blur_sigma_px");
  keys.Renamed("vision.canny_threshold", "vision.hough_canny_threshold");
  keys.Renamed("vision.votes", "vision.hough_votes");
  keys.Number("vision.noise_floor", c.edge_noise.floor, 0.0, 50.0, "gray levels",
              "least standard deviation of a picture's noise that the covariance assumes");
  keys.Number("vision.edge_shift_px", c.edge_noise.shift_px, 0.0, 2.0, "px",
              "how far lens and light may move a whole outline or side; part of the covariance");
  keys.Number("vision.corner_shift_px", c.edge_noise.corner_px, 0.0, 2.0, "px",
              "how far pixel grid and colours may move a corner, differently in each picture; part of the "
              "covariance");
  keys.Number("vision.radius_min_px", c.radius_min_px, 4.0, 500.0, "px",
              "smallest outline that is searched: radius of the circle of the same area");
  keys.Number("vision.radius_max_px", c.radius_max_px, 8.0, 2000.0, "px", "largest outline that is searched");
  keys.Number("vision.distance_min", c.distance_min, 0.01, 100.0, "m", "least distance of a target");
  keys.Number("vision.distance_max", c.distance_max, 0.01, 100.0, "m", "largest distance of a target");
  keys.Number("vision.confidence_min", c.confidence_min, 0.0, 1.0, "", "reject detections below it");
}

vision::DetectorConfig MakeVisionConfig(const VisionSettings& settings, const vision::Intrinsics& intrinsics,
                                        const TargetSettings& target) {
  vision::DetectorConfig config = settings.config;
  config.intrinsics = intrinsics;
  config.LookFor(MakeTarget(target));
  config.by = settings.method == "gray"    ? vision::FindBy::kGray
              : settings.method == "hough" ? vision::FindBy::kHough
                                           : vision::FindBy::kColour;
  const bool round = features::TraitsOf(config.kind).body != features::TargetBody::kPlate;
  if (config.by == vision::FindBy::kHough && !round) {
    throw InputError("vision.method = \"hough\" is not allowed: it finds only spheres and circles");
  }
  if (config.radius_min_px >= config.radius_max_px) {
    throw InputError("vision.radius_min_px must be below vision.radius_max_px");
  }
  if (config.distance_min >= config.distance_max) {
    throw InputError("vision.distance_min must be below vision.distance_max");
  }
  return config;
}

}  // namespace fovea::config
