// What stands on both sides of a polygon's sides, line by line: whether it is the target that ends there.
//
// A side of the target has the target's own colour within and something else without. Where something
// stands before the target, neither does; what stands there differs from the ground too, or there is nothing
// that could hide a part. And the edge of what hides goes on beyond the corners that it makes with the
// target's sides, where a side of the target ends.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/fit/profiles.hpp"
#include "firmware/vision/pose/intrinsics.hpp"

namespace fovea::vision {

// Keeps the memory that it works in. One thread uses it.
class SideEvidence {
 public:
  static constexpr double kBesidePx = 7.0;  // lines so near to what hides may see its edge

  using Colour = Eigen::Vector3f;

  // `in_any_light`: a coloured target is one in the sun and in the shade, where a shadow's edge crosses it
  // too.
  explicit SideEvidence(bool in_any_light) : in_any_light_(in_any_light) {}

  struct Side {
    int from = 0, to = 0;  // its lines
    double length_px = 0.0;
    double inward_u = 0.0, inward_v = 0.0;  // unit vector
    double offset_px = 0.0;                 // of its line along that, from the image's origin
    double seen = 0.0;                      // share of it where the target ends
    bool ends[2] = {false, false};          // seen up to its begin, its end
  };

  // `lines` cross the polygon's sides from within to without, side by side in the corners' order, each side's
  // from its begin to its end; `ends[k]` is one past side k's last.
  void Look(const cv::Mat& image, const Intrinsics& in, std::span<const ImagePoint> corners,
            std::span<const ProfileLine> lines, std::span<const int> ends);

  // Whether line i's edge can be taken for the side's: it is, and nothing that hides is near.
  [[nodiscard]] bool clear(int i) const { return clear_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Side& side(int k) const { return sides_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }  // the target ends at every line that is known
  [[nodiscard]] double against() const { return against_; }  // share of the outline that is not the target's
  // A side of which the edges of some lines are off: whether it is because something stands before them. Two
  // things meet there; the one that lies against the ground, as the other sides do, is the target's.
  [[nodiscard]] bool ExplainsBends(const std::array<bool, Profiles::kMaxLines>& off);
  // Corners to which the sides are not seen.
  [[nodiscard]] int CornersHidden() const;

  // Whether the edge along a side goes on beyond a corner, by more than `least` gray levels: then it is the
  // edge of what hides the target; or comes out again further on: then what is seen is a piece of the target.
  [[nodiscard]] bool SideGoesOn(const cv::Mat& image, const Intrinsics& in,
                                std::span<const ImagePoint> corners, double least) const;

 private:
  enum class Says : std::uint8_t {
    kUnknown,  // outside the image, or too near to a corner
    kSide,     // the target ends here
    kHidden,   // something stands before it
    kNot,      // the ground is where the target should be, or the target goes on
  };
  [[nodiscard]] bool IsTargets(const Colour& colour) const;
  [[nodiscard]] Says SaysOf(int i) const { return says_[static_cast<std::size_t>(i)]; }
  static bool StepBeyond(const cv::Mat& image, const Intrinsics& in, const ImagePoint& corner, double du,
                         double dv, int from, int to, Colour& step);
  static bool GoesOn(const cv::Mat& image, const Intrinsics& in, const ImagePoint& corner, double du,
                     double dv, double length, const Colour& own, double least);
  [[nodiscard]] double DepthOf(int but, double u, double v) const;
  [[nodiscard]] bool IsInside(int k, int i) const;
  void Sample(const cv::Mat& image, const Intrinsics& in);
  void Smooth(std::array<Colour, Profiles::kMaxLines>& colours,
              const std::array<bool, Profiles::kMaxLines>& known);
  template <class Counts>
  Colour MedianOf(const std::array<Colour, Profiles::kMaxLines>& colours, int from, int to, Counts counts);
  void Judge();
  void Describe();
  void FindClear(const Side& side, int beside);

  const bool in_any_light_;
  std::span<const ProfileLine> lines_;
  int sides_count_ = 0;
  int channels_ = 1;
  bool is_whole_ = false;
  double against_ = 0.0;
  double contrast_ = 0.0;
  Colour target_ = Colour::Zero();
  Colour ground_ = Colour::Zero();
  std::array<Side, Detection::kMaxCorners> sides_;
  std::array<Colour, Profiles::kMaxLines> inside_;
  std::array<Colour, Profiles::kMaxLines> outside_;
  std::array<bool, Profiles::kMaxLines> in_known_{};
  std::array<bool, Profiles::kMaxLines> out_known_{};
  std::array<Says, Profiles::kMaxLines> says_{};
  std::array<bool, Profiles::kMaxLines> clear_{};
  std::array<float, Profiles::kMaxLines> sorted_{};
  std::array<Colour, Profiles::kMaxLines> smooth_;
};

}  // namespace fovea::vision
