// First half of finding a ball: roughly where, by the source's way: back-projection of a colour histogram
// (or the gray image), Gaussian blur, Hough transform for circles. Good to a few pixels.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace fovea::vision {

enum class FindBy { kColour, kGray };

struct FinderConfig {
  FindBy by = FindBy::kColour;
  double hue_deg = 0.0;           // of the target; 0 is red, 120 green, 240 blue
  double hue_width_deg = 12.0;    // standard deviation of the hue
  double saturation_min = 0.35;   // below it a colour says nothing, 0 to 1
  double blur_sigma_px = 1.5;     // at half resolution
  double canny_threshold = 90.0;  // of the edges that vote; higher by itself where there are too many
  double votes = 14.0;            // a circle needs so many
  double radius_min_px = 10.0;
  double radius_max_px = 200.0;
  int candidates_max = 16;
};

struct Circle {
  double u_px = 0.0;
  double v_px = 0.0;
  double radius_px = 0.0;
};

class BallFinder {
 public:
  explicit BallFinder(const FinderConfig& config);

  // Circles in `image` (CV_8UC3 BGR or CV_8UC1), the best first; none when there is none. A gray image is
  // always searched as gray.
  const std::vector<Circle>& Find(const cv::Mat& image);

  // How much a BGR colour looks like the target's, 0 to 1; always 1 when it searches by gray.
  [[nodiscard]] double Likeness(double blue, double green, double red) const;

 private:
  [[nodiscard]] double EdgeThreshold();

  const FinderConfig config_;
  cv::Mat histogram_;  // [hue x saturation] likeness, 0 to 255
  cv::Mat half_, hsv_, likeness_, blurred_, dx_, dy_;
  std::vector<cv::Vec3f> hough_;
  std::vector<Circle> circles_;
};

}  // namespace fovea::vision
