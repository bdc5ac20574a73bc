// SPDX-License-Identifier: Apache-2.0
// Decides line by line, from the colours inside and outside of a polygon's sides, where the target ends.
//
// A side of the target has the target's colour inside and another colour outside. Where an object hides the
// target, the inside has the object's colour. That colour must differ from the ground's too; otherwise no
// object is there. The edge of a covering object continues beyond the corners that it forms with the target's
// sides; a side of the target ends there.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/fit/profiles.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "firmware/vision/picture.hpp"

namespace fovea::vision {

// Reuses its working memory. For one thread.
class SideEvidence {
 public:
  static constexpr double kBesidePx = 7.0;  // lines this near to a covering object may cross its edge

  using Colour = Eigen::Vector3f;

  // `in_any_light`: recognise a coloured target in sun and in shade, also if a shadow's edge crosses it.
  explicit SideEvidence(bool in_any_light) : in_any_light_(in_any_light) {}

  struct Side {
    int from = 0, to = 0;  // its lines, [from, to)
    double length_px = 0.0;
    double inward_u = 0.0, inward_v = 0.0;  // unit vector
    double offset_px = 0.0;                 // of its line from the image's origin, along `inward`
    double seen = 0.0;                      // share of its lines where the target ends
    bool ends[2] = {false, false};          // seen up to its beginning, up to its end
  };

  // `lines` cross the polygon's sides outward: side by side in the corners' order, each side from its
  // beginning to its end. `ends[k]` is one past side k's last line.
  void Look(const Picture& image, const Intrinsics& in, std::span<const ImagePoint> corners,
            std::span<const ProfileLine> lines, std::span<const int> ends);

  // Whether line i's edge can be used for the side: the target ends there, and no covering object is near.
  [[nodiscard]] bool clear(int i) const { return clear_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Side& side(int k) const { return sides_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }  // the target ends at every known line
  [[nodiscard]] double against() const { return against_; }  // share of the known lines that are kNot
  // Whether an object in front of the target explains the outlier edges `off` on each side: outside, the
  // side's other edges have the colour of the ground, and the outliers have another colour.
  [[nodiscard]] bool ExplainsBends(const std::array<bool, Profiles::kMaxLines>& off);
  // Number of corners that are not seen from both of their sides.
  [[nodiscard]] int CornersHidden() const;

  // Whether the edge along a side continues beyond a corner with a step above `least` [gray levels]: then it
  // is the edge of a covering object. Or it reappears further on: then only a piece of the target is seen.
  [[nodiscard]] bool SideGoesOn(const Picture& image, const Intrinsics& in,
                                std::span<const ImagePoint> corners, double least) const;

 private:
  enum class Says : std::uint8_t {
    kUnknown,  // outside the image, or too near to a corner
    kSide,     // the target ends here
    kHidden,   // an object hides the target here
    kNot,      // the ground lies inside, or the target continues outside
  };
  [[nodiscard]] bool IsLikeTargets(const Colour& colour) const;
  [[nodiscard]] bool HueTells() const;
  [[nodiscard]] bool HasTargetsHue(const Colour& colour) const;
  [[nodiscard]] Says SaysOf(int i) const { return says_[static_cast<std::size_t>(i)]; }
  static bool StepBeyond(const Picture& image, const Intrinsics& in, const ImagePoint& corner, double du,
                         double dv, int from, int to, Colour& step);
  static bool GoesOn(const Picture& image, const Intrinsics& in, const ImagePoint& corner, double du,
                     double dv, double length, const Colour& own, double least);
  [[nodiscard]] double DepthOf(int but, double u, double v) const;
  [[nodiscard]] bool IsInside(int k, int i) const;
  void Sample(const Picture& image, const Intrinsics& in);
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
