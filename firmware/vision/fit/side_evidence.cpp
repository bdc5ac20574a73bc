// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/fit/side_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::vision {
namespace {

constexpr double kDepthPx = 3.5;     // distance from the side of the first colour sample
constexpr int kDepths = 3;           // samples, 1 px apart
constexpr double kClearPx = 1.5;     // least distance of a sample from another side
constexpr int kMeanReach = 2;        // neighbours on each side in a line's mean colour
constexpr float kLike = 0.35F;       // colours nearer than this share of the contrast are alike
constexpr float kLikeGround = 0.2F;  // the same for the ground's colour
// In other light, the target's colour is scaled by a factor in this range, with at most this relative error.
constexpr float kDarkest = 0.15F;
constexpr float kBrightest = 6.0F;
constexpr float kSameHue = 0.3F;
constexpr float kColoured = 0.5F;  // least saturation of a target for this rule
constexpr double kEndPx = 12.0;    // a side shows its corner if it is seen up to this distance from it,
constexpr double kEndShare = 0.2;  // or up to this share of its length

// Reads the pixel at the ideal position (u, v); false outside the image.
bool ColourAt(const Picture& image, const Intrinsics& in, double u, double v, Eigen::Vector3f& colour) {
  in.Distort(u, v);
  u += 0.5;
  v += 0.5;
  if (!(u >= 0.0 && v >= 0.0 && u < image.cols && v < image.rows)) {
    return false;
  }
  const auto x = static_cast<int>(u);
  const auto y = static_cast<int>(v);
  image.Need({x, y, 1, 1});
  const int channels = image.channels();
  const std::uint8_t* pixel = image.ptr<std::uint8_t>(y) + x * channels;
  if (channels == 3) {
    colour = Eigen::Vector3f(pixel[0], pixel[1], pixel[2]);
  } else {
    colour = Eigen::Vector3f(pixel[0], 0.0F, 0.0F);
  }
  return true;
}

}  // namespace

void SideEvidence::Look(const Picture& image, const Intrinsics& in, std::span<const ImagePoint> corners,
                        std::span<const ProfileLine> lines, std::span<const int> ends) {
  lines_ = lines;
  sides_count_ = static_cast<int>(corners.size());
  channels_ = image.channels();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const ImagePoint& a = corners[k];
    const ImagePoint& b = corners[(k + 1) % corners.size()];
    Side& side = sides_[k];
    side = Side{};
    side.from = k == 0 ? 0 : ends[k - 1];
    side.to = ends[k];
    side.length_px = std::hypot(b.u_px - a.u_px, b.v_px - a.v_px);
    side.inward_u = (a.v_px - b.v_px) / side.length_px;
    side.inward_v = (b.u_px - a.u_px) / side.length_px;
    side.offset_px = side.inward_u * a.u_px + side.inward_v * a.v_px;
  }
  Sample(image, in);
  Judge();
  Describe();
}

// How far a point is inside all sides except `but` [px].
double SideEvidence::DepthOf(int but, double u, double v) const {
  double depth = 1e9;
  for (int k = 0; k < sides_count_; ++k) {
    const Side& side = sides_[static_cast<std::size_t>(k)];
    if (k != but) {
      depth = std::min(depth, side.inward_u * u + side.inward_v * v - side.offset_px);
    }
  }
  return depth;
}

// Whether the nearest and the furthest inner sample of line i of side `k` are clear of the other sides.
bool SideEvidence::IsInside(int k, int i) const {
  const ProfileLine& l = lines_[static_cast<std::size_t>(i)];
  const auto is_clear = [&](double depth) {
    return DepthOf(k, l.u_px - depth * l.nu, l.v_px - depth * l.nv) > kClearPx;
  };
  return is_clear(kDepthPx) && is_clear(kDepthPx + kDepths - 1);
}

void SideEvidence::Sample(const Picture& image, const Intrinsics& in) {
  for (int k = 0; k < sides_count_; ++k) {
    const Side& side = sides_[static_cast<std::size_t>(k)];
    // The region clear of the other sides is convex: all lines between two clear lines are clear too.
    int first = side.from;
    int last = side.to - 1;
    while (first < side.to && !IsInside(k, first)) {
      ++first;
    }
    while (last > first && !IsInside(k, last)) {
      --last;
    }
    for (int i = side.from; i < side.to; ++i) {
      const auto line = static_cast<std::size_t>(i);
      const ProfileLine& l = lines_[line];
      const bool is_inside = i >= first && i <= last;
      Colour colour;
      Colour within = Colour::Zero();
      Colour without = Colour::Zero();
      int count_in = 0;
      int count_out = 0;
      for (int d = 0; d < kDepths; ++d) {
        const double depth = kDepthPx + d;
        const double u = l.u_px - depth * l.nu;
        const double v = l.v_px - depth * l.nv;
        if ((is_inside || DepthOf(k, u, v) > kClearPx) && ColourAt(image, in, u, v, colour)) {
          within += colour;
          ++count_in;
        }
        if (ColourAt(image, in, l.u_px + depth * l.nu, l.v_px + depth * l.nv, colour)) {
          without += colour;
          ++count_out;
        }
      }
      in_known_[line] = count_in > 0;
      out_known_[line] = count_out == kDepths;
      inside_[line] = within / static_cast<float>(std::max(count_in, 1));
      outside_[line] = without / static_cast<float>(std::max(count_out, 1));
    }
  }
  Smooth(inside_, in_known_);
  Smooth(outside_, out_known_);
}

// Replaces each line's colour by the mean over its neighbours on the same side.
void SideEvidence::Smooth(std::array<Colour, Profiles::kMaxLines>& colours,
                          const std::array<bool, Profiles::kMaxLines>& known) {
  for (int k = 0; k < sides_count_; ++k) {
    const Side& side = sides_[static_cast<std::size_t>(k)];
    for (int i = side.from; i < side.to; ++i) {
      Colour sum = Colour::Zero();
      int count = 0;
      for (int j = std::max(side.from, i - kMeanReach); j <= std::min(side.to - 1, i + kMeanReach); ++j) {
        if (known[static_cast<std::size_t>(j)]) {
          sum += colours[static_cast<std::size_t>(j)];
          ++count;
        }
      }
      smooth_[static_cast<std::size_t>(i)] = sum / static_cast<float>(std::max(count, 1));
    }
  }
  colours = smooth_;
}

// Median per channel over the known lines in [from, to) for which `counts` is true; black if there are none.
template <class Counts>
SideEvidence::Colour SideEvidence::MedianOf(const std::array<Colour, Profiles::kMaxLines>& colours, int from,
                                            int to, Counts counts) {
  Colour median = Colour::Zero();
  for (int c = 0; c < channels_; ++c) {
    std::size_t count = 0;
    for (int i = from; i < to; ++i) {
      const auto line = static_cast<std::size_t>(i);
      if (in_known_[line] && out_known_[line] && counts(i)) {
        sorted_[count++] = colours[line][c];
      }
    }
    if (count == 0) {
      return median;
    }
    const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(count));
    median[c] = *middle;
  }
  return median;
}

bool SideEvidence::IsLikeTargets(const Colour& colour) const {
  const auto contrast = static_cast<float>(contrast_);
  return (colour - target_).squaredNorm() < kLike * kLike * contrast * contrast;
}

// The rule of hue holds for a coloured target alone.
bool SideEvidence::HueTells() const {
  const float most = target_.maxCoeff();
  return in_any_light_ && channels_ == 3 && most - target_.minCoeff() > kColoured * most;
}

bool SideEvidence::HasTargetsHue(const Colour& colour) const {
  const float light = colour.dot(target_) / target_.squaredNorm();
  return light > kDarkest && light < kBrightest &&
         (colour - light * target_).squaredNorm() <
             kSameHue * kSameHue * light * light * target_.squaredNorm();
}

void SideEvidence::Judge() {
  const int count = static_cast<int>(lines_.size());
  const auto any = [](int /*i*/) { return true; };
  const auto is_side = [this](int i) { return SaysOf(i) == Says::kSide; };
  target_ = MedianOf(inside_, 0, count, any);
  ground_ = MedianOf(outside_, 0, count, any);
  const bool hue_tells = HueTells();
  for (int turn = 0; turn < 2; ++turn) {
    const float contrast = (target_ - ground_).norm();
    contrast_ = static_cast<double>(contrast);
    const float ground2 = kLikeGround * kLikeGround * contrast * contrast;
    for (int i = 0; i < count; ++i) {
      const auto line = static_cast<std::size_t>(i);
      if (!in_known_[line] || !out_known_[line]) {
        says_[line] = Says::kUnknown;
        continue;
      }
      const Colour& inside = inside_[line];
      if (IsLikeTargets(inside) || (hue_tells && HasTargetsHue(inside))) {
        // In a shade, a dark ground is like the target in all but hue.
        const Colour& outside = outside_[line];
        const bool goes_on = hue_tells ? HasTargetsHue(outside) : IsLikeTargets(outside);
        says_[line] = goes_on ? Says::kNot : Says::kSide;
      } else {
        says_[line] = (inside - ground_).squaredNorm() < ground2 ? Says::kNot : Says::kHidden;
      }
    }
    // Now the sides are known: the ground's colour is the colour outside of them.
    ground_ = MedianOf(outside_, 0, count, is_side);
  }
}

void SideEvidence::Describe() {
  int known = 0;
  int wrong = 0;
  is_whole_ = true;
  for (int k = 0; k < sides_count_; ++k) {
    Side& side = sides_[static_cast<std::size_t>(k)];
    int seen = 0;
    int of_side = 0;
    int first = side.to;
    int last = side.from - 1;
    for (int i = side.from; i < side.to; ++i) {
      const Says says = SaysOf(i);
      if (says == Says::kUnknown) {
        continue;
      }
      ++of_side;
      if (says == Says::kSide) {
        ++seen;
        first = std::min(first, i);
        last = i;
      } else {
        wrong += says == Says::kNot ? 1 : 0;
        is_whole_ = false;
      }
    }
    known += of_side;
    side.seen = of_side > 0 ? static_cast<double>(seen) / of_side : 0.0;
    const double spacing_px = side.length_px / std::max(side.to - side.from, 1);
    const double end_px = std::max(kEndPx, kEndShare * side.length_px);
    side.ends[0] = seen > 0 && (first - side.from) * spacing_px < end_px;
    side.ends[1] = seen > 0 && (side.to - 1 - last) * spacing_px < end_px;
    FindClear(side, static_cast<int>(std::ceil(kBesidePx / spacing_px)));
  }
  against_ = known > 0 ? static_cast<double>(wrong) / known : 1.0;
}

// An unknown line counts like the nearest known one.
void SideEvidence::FindClear(const Side& side, int beside) {
  const auto is_clear = [&](int i) {
    for (int off = 0; off < side.to - side.from; ++off) {
      for (const int j : {i - off, i + off}) {
        if (j >= side.from && j < side.to && SaysOf(j) != Says::kUnknown) {
          return SaysOf(j) == Says::kSide;
        }
      }
    }
    return true;
  };
  int since = beside;  // lines since the last one that is not clear
  for (int i = side.from; i < side.to; ++i) {
    since = is_clear(i) ? since + 1 : 0;
    clear_[static_cast<std::size_t>(i)] = since > beside;
  }
  since = beside;
  for (int i = side.to - 1; i >= side.from; --i) {
    since = is_clear(i) ? since + 1 : 0;
    clear_[static_cast<std::size_t>(i)] = clear_[static_cast<std::size_t>(i)] && since > beside;
  }
}

bool SideEvidence::ExplainsBends(const std::array<bool, Profiles::kMaxLines>& off) {
  constexpr int kFew = 2;  // may be off by chance
  const float like = kLikeGround * static_cast<float>(contrast_);
  for (int k = 0; k < sides_count_; ++k) {
    const Side& side = sides_[static_cast<std::size_t>(k)];
    const auto is_off = [&](int i) { return off[static_cast<std::size_t>(i)]; };
    const auto is_on = [&](int i) { return !is_off(i) && SaysOf(i) == Says::kSide; };
    int count = 0;
    for (int i = side.from; i < side.to; ++i) {
      count += is_off(i) ? 1 : 0;
    }
    if (count > kFew && ((MedianOf(outside_, side.from, side.to, is_on) - ground_).norm() > like ||
                         (MedianOf(outside_, side.from, side.to, is_off) - ground_).norm() < like)) {
      return false;
    }
  }
  return true;
}

int SideEvidence::CornersHidden() const {
  int hidden = 0;
  for (int k = 0; k < sides_count_; ++k) {
    const Side& ending = sides_[static_cast<std::size_t>((k + sides_count_ - 1) % sides_count_)];
    const Side& beginning = sides_[static_cast<std::size_t>(k)];
    hidden += ending.ends[1] && beginning.ends[0] ? 0 : 1;
  }
  return hidden;
}

// The colour step across the line through a corner along (du, dv), at [from, to) px beyond the corner: colour
// on the right minus colour on the left. False if over half of the samples are outside the image.
bool SideEvidence::StepBeyond(const Picture& image, const Intrinsics& in, const ImagePoint& corner, double du,
                              double dv, int from, int to, Colour& step) {
  constexpr int kNearest = 2;  // beside the line [px]
  constexpr int kFurthest = 4;
  step.setZero();
  int pairs = 0;
  for (int far = from; far < to; ++far) {
    for (int aside = kNearest; aside <= kFurthest; ++aside) {
      const double u = corner.u_px + far * du;
      const double v = corner.v_px + far * dv;
      Colour left;
      Colour right;
      if (ColourAt(image, in, u + aside * dv, v - aside * du, left) &&
          ColourAt(image, in, u - aside * dv, v + aside * du, right)) {
        step += right - left;
        ++pairs;
      }
    }
  }
  step /= static_cast<float>(std::max(pairs, 1));
  return 2 * pairs >= (to - from) * (kFurthest - kNearest + 1);
}

bool SideEvidence::SideGoesOn(const Picture& image, const Intrinsics& in, std::span<const ImagePoint> corners,
                              double least) const {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const ImagePoint& a = corners[i];
    const ImagePoint& b = corners[(i + 1) % corners.size()];
    const double length = std::hypot(b.u_px - a.u_px, b.v_px - a.v_px);
    const double du = (b.u_px - a.u_px) / length;
    const double dv = (b.v_px - a.v_px) / length;
    // Looking towards the side's end, the inside is on the right; towards its beginning, on the left.
    const Colour own = target_ - ground_;
    if (GoesOn(image, in, b, du, dv, length, own, least) ||
        GoesOn(image, in, a, -du, -dv, length, -own, least)) {
      return true;
    }
  }
  return false;
}

// `own`: the side's own step, right minus left, looking along (du, dv) with v downwards.
bool SideEvidence::GoesOn(const Picture& image, const Intrinsics& in, const ImagePoint& corner, double du,
                          double dv, double length, const Colour& own, double least) {
  constexpr int kFirst = 4;  // distance beyond the corner, which is blurred [px]
  constexpr int kPart = 3;   // length of a part [px]; an edge that only crosses is not in all parts
  constexpr std::size_t kParts = 3;
  constexpr double kFurthest = 0.6;  // of the side: where it can reappear behind a narrow object
  constexpr float kSame = 0.4F;      // steps that differ by less than this share belong to one edge
  std::array<Colour, kParts> steps;
  std::size_t known = 0;
  const int last = std::max(kFirst, static_cast<int>(kFurthest * length)) + kPart * static_cast<int>(kParts);
  for (int from = kFirst; from + kPart <= last; from += kPart) {
    std::rotate(steps.begin(), steps.begin() + 1, steps.end());
    if (!StepBeyond(image, in, corner, du, dv, from, from + kPart, steps.back())) {
      return false;
    }
    if (++known < kParts) {
      continue;
    }
    if (known == kParts) {
      Colour mean = Colour::Zero();
      for (const Colour& step : steps) {
        mean += step / static_cast<float>(kParts);
      }
      const auto size = static_cast<double>(mean.norm());
      if (size > least && std::all_of(steps.begin(), steps.end(), [&](const Colour& step) {
            return static_cast<double>(step.dot(mean)) > 0.5 * least * size;
          })) {
        return true;
      }
    } else if (std::all_of(steps.begin(), steps.end(), [&](const Colour& step) {
                 return (step - own).squaredNorm() < kSame * kSame * own.squaredNorm();
               })) {
      return true;
    }
  }
  return false;
}

}  // namespace fovea::vision
