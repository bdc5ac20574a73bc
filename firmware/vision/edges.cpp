#include "fovea/vision/edges.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "fovea/model/types.hpp"

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

constexpr double kPi = 3.14159265358979323846;
constexpr double kMinContrast = 6.0;  // gray levels between the two sides, or it is no edge
constexpr int kHalf = 6;              // samples of a fine profile on each side of the edge, one per pixel
constexpr int kSamples = 2 * kHalf + 1;
constexpr int kClear = 2;  // samples nearer to the edge than this belong to neither side
constexpr int kInner = 4;  // the area is taken from this far inside

// Reads the image between its pixels. Gray images count as three equal channels.
class Sampler {
 public:
  explicit Sampler(const cv::Mat& image) : image_(image), channels_(image.channels()) {}

  [[nodiscard]] bool Contains(double u, double v) const {
    return u >= 0.0 && v >= 0.0 && u <= image_.cols - 1.001 && v <= image_.rows - 1.001;
  }
  // Bilinear; (u, v) must be inside.
  [[nodiscard]] Vec3 At(double u, double v) const {
    const int x = static_cast<int>(u);
    const int y = static_cast<int>(v);
    const double a = u - x;
    const double b = v - y;
    const std::uint8_t* top = image_.ptr<std::uint8_t>(y) + x * channels_;
    const std::uint8_t* bottom = image_.ptr<std::uint8_t>(y + 1) + x * channels_;
    Vec3 value;
    for (int c = 0; c < 3; ++c) {
      const int k = channels_ == 1 ? 0 : c;
      const double upper = top[k] + a * (top[k + channels_] - top[k]);
      const double lower = bottom[k] + a * (bottom[k + channels_] - bottom[k]);
      value[c] = upper + b * (lower - upper);
    }
    return value;
  }

 private:
  const cv::Mat& image_;
  int channels_;
};

// The fine profiles of all rays; offset 0 is the expected edge, negative inside.
struct Profiles {
  std::array<std::array<Vec3, kSamples>, EdgeSet::kMaxRays> colour;
  std::array<bool, EdgeSet::kMaxRays> valid{};
  std::array<Vec3, EdgeSet::kMaxRays> step;       // inside less outside
  std::array<Vec3, EdgeSet::kMaxRays> direction;  // unit vector of the step, smoothed over neighbours
};

// Means over the samples from offset `from` to `to`.
Vec3 MeanOf(const std::array<Vec3, kSamples>& colour, int from, int to) {
  Vec3 sum = Vec3::Zero();
  for (int offset = from; offset <= to; ++offset) {
    sum += colour[static_cast<std::size_t>(offset + kHalf)];
  }
  return sum / (to - from + 1);
}

void ReadProfiles(const Sampler& sampler, const RayFan& fan, Profiles& profiles) {
  for (int i = 0; i < fan.rays; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double du = 0.0;
    double dv = 0.0;
    fan.Direction(i, du, dv);
    const double first = fan.distance_px[k] - kHalf;
    const double last = fan.distance_px[k] + kHalf;
    profiles.valid[k] = first >= 0.0 && sampler.Contains(fan.u_px + first * du, fan.v_px + first * dv) &&
                        sampler.Contains(fan.u_px + last * du, fan.v_px + last * dv);
    if (!profiles.valid[k]) {
      continue;
    }
    for (int sample = 0; sample < kSamples; ++sample) {
      const double r = first + sample;
      profiles.colour[k][static_cast<std::size_t>(sample)] = sampler.At(fan.u_px + r * du, fan.v_px + r * dv);
    }
    profiles.step[k] =
        MeanOf(profiles.colour[k], -kInner, -kClear) - MeanOf(profiles.colour[k], kClear, kHalf);
    profiles.valid[k] = profiles.step[k].norm() >= kMinContrast;
  }
}

// The step's direction in colour space, from the ray and its neighbours: a direction that follows one ray's
// noise would count that noise as contrast.
void SmoothDirections(int rays, Profiles& profiles) {
  const int reach = std::max(1, rays / 16);
  for (int i = 0; i < rays; ++i) {
    Vec3 sum = Vec3::Zero();
    for (int j = -reach; j <= reach; ++j) {
      const auto k = static_cast<std::size_t>((i + j + rays) % rays);
      if (profiles.valid[k]) {
        sum += profiles.step[k];
      }
    }
    profiles.direction[static_cast<std::size_t>(i)] = sum / std::max(sum.norm(), 1e-9);
  }
}

// How bright a ball's surface stands `d` inside its outline of radius `r`, and its integral from 0 to d.
double Turn(double d, double r) { return std::sqrt(std::max(2.0 * d / r - d * d / (r * r), 0.0)); }
double TurnIntegral(double d, double r) {
  const double t = std::clamp(1.0 - d / r, -1.0, 1.0);
  return 0.5 * r * (std::acos(t) - t * std::sqrt(1.0 - t * t));
}

// c0, c1, s1 of the shading: least squares over the slopes of all rays' inner samples against Turn.
Vec3 FitShading(const RayFan& fan, const Profiles& profiles, double radius_px) {
  Mat3 normal = Mat3::Identity() * 1e-9;
  Vec3 right = Vec3::Zero();
  for (int i = 0; i < fan.rays; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!profiles.valid[k]) {
      continue;
    }
    double sum_z = 0.0, sum_p = 0.0, sum_zz = 0.0, sum_zp = 0.0;
    constexpr int kCount = kHalf - kClear + 1;
    for (int d = kClear; d <= kHalf; ++d) {
      const double z = Turn(d, radius_px);
      const double p = profiles.direction[k].dot(profiles.colour[k][static_cast<std::size_t>(kHalf - d)]);
      sum_z += z;
      sum_p += p;
      sum_zz += z * z;
      sum_zp += z * p;
    }
    const double spread = sum_zz - sum_z * sum_z / kCount;
    const double slope = (sum_zp - sum_z * sum_p / kCount) / spread;
    double du = 0.0;
    double dv = 0.0;
    fan.Direction(i, du, dv);
    const Vec3 basis(1.0, du, dv);
    normal += basis * basis.transpose();
    right += basis * slope;
  }
  return normal.inverse() * right;
}

// The edge's distance from its expected place, from the area under the profile. False when it is too far off
// or there is no step in the expected direction.
bool SolveEdge(const std::array<Vec3, kSamples>& colour, const Vec3& direction, double c, double radius_px,
               double& shift, double& contrast) {
  const double outside = direction.dot(MeanOf(colour, kClear, kHalf));
  // The inner level less the shading's share: a in a + c z(d).
  double level = 0.0;
  for (int d = kClear; d <= kInner; ++d) {
    level += direction.dot(colour[static_cast<std::size_t>(kHalf - d)]) -
             (c == 0.0 ? 0.0 : c * Turn(d, radius_px));
  }
  level /= kInner - kClear + 1;
  contrast = level - outside;
  const double inner_contrast = contrast + (c == 0.0 ? 0.0 : c * Turn(kClear, radius_px));
  if (inner_contrast < kMinContrast) {
    return false;
  }
  double area = 0.0;
  for (int offset = -kInner; offset <= kClear; ++offset) {
    area += direction.dot(colour[static_cast<std::size_t>(offset + kHalf)]) - outside;
  }
  // (a - outside) D + c Z(D) = area, for the distance D from the inner border to the edge.
  constexpr double kBorder = kInner + 0.5;
  double distance = kBorder;
  if (c == 0.0) {
    distance = area / contrast;
  } else {
    for (int i = 0; i < 4; ++i) {
      const double value = contrast * distance + c * TurnIntegral(distance, radius_px) - area;
      const double slope = contrast + c * Turn(distance, radius_px);
      if (!(slope > 0.5 * kMinContrast)) {
        return false;
      }
      distance = std::clamp(distance - value / slope, 0.5, kBorder + kHalf);
    }
  }
  shift = distance - kBorder;
  contrast = inner_contrast;
  return std::fabs(shift) <= kClear + 0.5;
}

}  // namespace

void RayFan::Direction(int ray, double& du, double& dv) const {
  const double angle = 2.0 * kPi * ray / rays;
  du = std::cos(angle);
  dv = std::sin(angle);
}

void FindCoarseEdges(const cv::Mat& image, const RayFan& fan, double search_px, EdgeSet& edges) {
  constexpr int kBox = 3;  // samples averaged on each side of a step
  constexpr int kMaxSamples = 160;
  const Sampler sampler(image);
  std::array<Vec3, kMaxSamples> profile;
  edges.count = 0;
  edges.rays = fan.rays;
  for (int ray = 0; ray < fan.rays; ++ray) {
    double du = 0.0;
    double dv = 0.0;
    fan.Direction(ray, du, dv);
    const double expected = fan.distance_px[static_cast<std::size_t>(ray)];
    const double first = std::max(expected - search_px, 3.0) - kBox;
    const int wanted = std::min(static_cast<int>(expected + search_px - first) + kBox + 1, kMaxSamples);
    int have = 0;
    for (; have < wanted; ++have) {
      const double r = first + have;
      if (r < 0.0 || !sampler.Contains(fan.u_px + r * du, fan.v_px + r * dv)) {
        break;
      }
      profile[static_cast<std::size_t>(have)] = sampler.At(fan.u_px + r * du, fan.v_px + r * dv);
    }
    double best = kMinContrast * kMinContrast;
    double distance = -1.0;
    for (int k = kBox; k + kBox < have; ++k) {
      Vec3 step = Vec3::Zero();
      for (int i = 1; i <= kBox; ++i) {
        step += profile[static_cast<std::size_t>(k - i)] - profile[static_cast<std::size_t>(k + i)];
      }
      const double size2 = step.squaredNorm() / (kBox * kBox);
      if (size2 > best) {
        best = size2;
        distance = first + k;
      }
    }
    if (distance > 0.0) {
      edges.list[static_cast<std::size_t>(edges.count++)] = {fan.u_px + distance * du,
                                                             fan.v_px + distance * dv, du, dv};
    }
  }
}

void MeasureFineEdges(const cv::Mat& image, const RayFan& fan, double radius_px, EdgeSet& edges) {
  Profiles profiles;
  ReadProfiles(Sampler(image), fan, profiles);
  SmoothDirections(fan.rays, profiles);
  const bool shaded = radius_px > 2.0 * kHalf;
  const Vec3 shading = shaded ? FitShading(fan, profiles, radius_px) : Vec3(Vec3::Zero());
  edges.count = 0;
  edges.rays = fan.rays;
  edges.contrast = 0.0;
  for (int i = 0; i < fan.rays; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!profiles.valid[k]) {
      continue;
    }
    double du = 0.0;
    double dv = 0.0;
    fan.Direction(i, du, dv);
    const double c = shaded ? shading.dot(Vec3(1.0, du, dv)) : 0.0;
    double shift = 0.0;
    double contrast = 0.0;
    if (!SolveEdge(profiles.colour[k], profiles.direction[k], c, radius_px, shift, contrast)) {
      continue;
    }
    const double distance = fan.distance_px[k] + shift;
    edges.list[static_cast<std::size_t>(edges.count++)] = {fan.u_px + distance * du, fan.v_px + distance * dv,
                                                           du, dv};
    edges.contrast += contrast;
  }
  if (edges.count > 0) {
    edges.contrast /= edges.count;
  }
}

}  // namespace fovea::vision
