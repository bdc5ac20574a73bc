// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/fit/profiles.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "firmware/vision/fit/shading.hpp"
#include "firmware/vision/fit/step_table.hpp"

namespace fovea::vision {
namespace {

constexpr double kMinContrast = 4.0;  // least step of an edge [gray levels]
constexpr double kStartNoise = 2.0;   // [gray levels], until it is measured
constexpr int kClear = 2;             // samples nearer to the edge than this belong to neither side
constexpr int kSurelyOut = 4;         // samples at least this far outside are the background's
constexpr float kShareOfAll = 0.1F;   // weight of the background's variation around the whole polygon
constexpr float kColourNoise = 2.0F;  // least standard deviation of a background's colour [gray levels]

const StepTable kStep;

// Four samples at a time, in a fixed order: the sums are equal on every machine.
using Four = float __attribute__((vector_size(16)));
Four Load(const float* from) {
  Four four;
  std::memcpy(&four, from, sizeof four);
  return four;
}
double Total(Four sum) { return static_cast<double>((sum[0] + sum[1]) + (sum[2] + sum[3])); }

// Fixed point, which takes half of the time: positions in units of 2^-16 px, interpolated brightness in units
// of 2^-22.
constexpr int kPlaceBits = 16;
constexpr int kShareBits = 11;
constexpr float kGrey = 128.0F;  // subtracted, so that sums of squares keep their precision
std::int32_t PlaceOf(double px) { return static_cast<std::int32_t>(px * (1 << kPlaceBits)); }

template <int kChannels>
void Interpolate(const Picture& image, std::int32_t u, std::int32_t v, float* out) {
  constexpr std::int32_t kMask = (1 << kPlaceBits) - 1;
  constexpr float kUnit = 1.0F / (1 << (2 * kShareBits));
  const std::int32_t a = (u & kMask) >> (kPlaceBits - kShareBits);
  const std::int32_t b = (v & kMask) >> (kPlaceBits - kShareBits);
  const std::uint8_t* top = image.ptr<std::uint8_t>(v >> kPlaceBits) + (u >> kPlaceBits) * kChannels;
  const std::uint8_t* bottom = top + image.step;
  for (int c = 0; c < kChannels; ++c) {
    const std::int32_t upper = (top[c] << kShareBits) + a * (top[c + kChannels] - top[c]);
    const std::int32_t lower = (bottom[c] << kShareBits) + a * (bottom[c + kChannels] - bottom[c]);
    out[c] = static_cast<float>((upper << kShareBits) + b * (lower - upper)) * kUnit;
  }
}

}  // namespace

void Profiles::Read(const Picture& image, const Intrinsics& in, const ProfileLine* lines, int count,
                    bool closed) {
  count_ = std::min(count, kMaxLines);
  closed_ = closed;
  shaded_ = false;
  noise_ = kStartNoise;
  gray_ = image.channels() == 1;
  const double u_max = image.cols - 1.001;
  const double v_max = image.rows - 1.001;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    lines_[k] = lines[i];
    double u = lines_[k].u_px;
    double v = lines_[k].v_px;
    double nu = lines_[k].nu;
    double nv = lines_[k].nv;
    if (!in.lens.IsZero()) {
      double u1 = u + nu;
      double v1 = v + nv;
      in.Distort(u, v);
      in.Distort(u1, v1);
      nu = u1 - u;
      nv = v1 - v;
    }
    const double ua = u - kHalf * nu;
    const double va = v - kHalf * nv;
    const double ub = u + kHalf * nu;
    const double vb = v + kHalf * nv;
    readable_[k] = std::min(ua, ub) >= 0.001 && std::min(va, vb) >= 0.001 && std::max(ua, ub) < u_max &&
                   std::max(va, vb) < v_max;
    if (!readable_[k]) {
      continue;
    }
    image.Need({cv::Point(static_cast<int>(std::min(ua, ub)), static_cast<int>(std::min(va, vb))),
                cv::Point(static_cast<int>(std::max(ua, ub)) + 2, static_cast<int>(std::max(va, vb)) + 2)});
    const std::int32_t step_u = PlaceOf(nu);
    const std::int32_t step_v = PlaceOf(nv);
    std::int32_t at_u = PlaceOf(u) - kHalf * step_u;
    std::int32_t at_v = PlaceOf(v) - kHalf * step_v;
    for (std::size_t j = 0; j < kSamples; ++j, at_u += step_u, at_v += step_v) {
      if (gray_) {
        Interpolate<1>(image, at_u, at_v, &value_[k][j + kPad]);
        value_[k][j + kPad] -= kGrey;
      } else {
        Interpolate<3>(image, at_u, at_v, &colour_[k][3 * j]);
      }
    }
  }
  if (!gray_) {
    ProjectColours(closed);
  }
  MeasureQuiet();
}

// Measures the noise away from the edge by second differences, which slow brightness changes do not affect.
void Profiles::MeasureQuiet() {
  std::array<float, kMaxLines> rough;
  std::size_t count = 0;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!readable_[k]) {
      continue;
    }
    float sum = 0.0F;
    for (const std::size_t j : {std::size_t{kPad + 1}, std::size_t{kPad + 2},
                                std::size_t{kPad + kSamples - 3}, std::size_t{kPad + kSamples - 2}}) {
      const float second = value_[k][j - 1] - 2.0F * value_[k][j] + value_[k][j + 1];
      sum += second * second;
    }
    rough[count++] = sum / 4.0F;
  }
  if (count == 0) {
    return;
  }
  const auto middle = rough.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(rough.begin(), middle, rough.begin() + static_cast<std::ptrdiff_t>(count));
  // The mean square is six times the variance, of which interpolation leaves about a third. The median of a
  // mean of four squares is 0.84 of its mean.
  quiet_ = std::sqrt(static_cast<double>(*middle) / 1.7);
}

// Projects colours on the direction that separates inside from outside: the step's, turned away from those in
// which the background itself varies beside the line (Fisher's linear discriminant). On the step's own
// direction, a border between two backgrounds near a side would look like a part of the step and shift it.
// The step is a mean over neighbours: one from a single line's noise would count that noise as contrast.
void Profiles::ProjectColours(bool closed) {
  std::array<Eigen::Vector3f, kMaxLines> step;
  Background all;
  surface_.setZero();
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    step[k].setZero();
    background_[k] = Background{};
    if (!readable_[k]) {
      continue;
    }
    for (int j = 0; j <= kHalf - kClear; ++j) {
      const auto inner = static_cast<std::size_t>(3 * j);
      const auto outer = static_cast<std::size_t>(3 * (kSamples - 1 - j));
      const Eigen::Map<const Eigen::Vector3f> inside(&colour_[k][inner]);
      const Eigen::Map<const Eigen::Vector3f> outside(&colour_[k][outer]);
      step[k] += inside - outside;
      surface_ += inside;
      if (j <= kHalf - kSurelyOut) {
        background_[k].Add(outside);
      }
    }
    all.Add(background_[k]);
  }
  surface_ /= std::max(surface_.norm(), 1e-6F);
  const Eigen::Matrix3f least =
      kShareOfAll * all.Covariance() + kColourNoise * kColourNoise * Eigen::Matrix3f::Identity();
  const int reach = std::max(1, count_ / 20);
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!readable_[k]) {
      continue;
    }
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Background near;
    for (int j = i - reach; j <= i + reach; ++j) {
      if (closed || (j >= 0 && j < count_)) {
        const auto other = static_cast<std::size_t>((j + count_) % count_);
        sum += step[other];
        near.Add(background_[other]);
      }
    }
    if (!closed) {
      sum = (near.Covariance() + least).ldlt().solve(sum).eval();
    }
    sum /= std::max(sum.norm(), 1e-6F);
    along_[k] = static_cast<double>(sum.dot(surface_));
    for (std::size_t j = 0; j < kSamples; ++j) {
      value_[k][j + kPad] = sum.dot(Eigen::Map<const Eigen::Vector3f>(&colour_[k][3 * j])) - kGrey;
    }
  }
}

// Samples of the blurred step at each of kPhases positions between two pixels, and their sums of products.
void Profiles::MakeSteps(double blur_px) {
  const double reach = std::clamp(2.2 * blur_px + 2.0, 3.0, kHalf - 1.0);
  half_ = 2 * static_cast<int>(std::ceil(0.5 * reach));
  for (int phase = 0; phase < kPhases; ++phase) {
    Step& s = steps_[static_cast<std::size_t>(phase)];
    s = Step{};
    const double middle = half_ - 1 + static_cast<double>(phase) / kPhases;
    for (int t = 0; t < 2 * half_; ++t) {
      const double off = t - middle;
      if (std::fabs(off) > reach) {
        continue;
      }
      const auto j = static_cast<std::size_t>(t);
      double q = 0.0;
      double density = 0.0;
      kStep.At(off / blur_px, q, density);
      s.used[j] = 1.0F;
      s.q[j] = static_cast<float>(q);
      s.density[j] = static_cast<float>(density / blur_px);
      s.wider[j] = static_cast<float>(off / (blur_px * blur_px) * density);
      s.turn[j] = shaded_ ? static_cast<float>(q * MeanSurfaceTurn(-off, radius_px_)) : 0.0F;
    }
    s.whole = Products(s, 0, 2 * half_);
  }
}

// Over samples [from, to) of the step.
Profiles::Sums Profiles::Products(const Step& s, int from, int to) {
  Sums sum;
  for (int t = from; t < to; ++t) {
    const auto j = static_cast<std::size_t>(t);
    const auto q = static_cast<double>(s.q[j]);
    const auto d = static_cast<double>(s.density[j]);
    const auto b = static_cast<double>(s.wider[j]);
    const auto z = static_cast<double>(s.turn[j]);
    sum.n += static_cast<double>(s.used[j]);
    sum.q += q;
    sum.qq += q * q;
    sum.d += d;
    sum.dq += d * q;
    sum.dd += d * d;
    sum.b += b;
    sum.bq += b * q;
    sum.bb += b * b;
    sum.z += z;
    sum.zq += z * q;
    sum.zd += z * d;
    sum.zb += z * b;
    sum.zz += z * z;
  }
  sum.p = sum.n - sum.q;
  sum.qp = sum.q - sum.qq;
  sum.pp = sum.p - sum.qp;
  const double det = std::max(sum.qq * sum.pp - sum.qp * sum.qp, 1e-9);
  const double dp = sum.d - sum.dq;
  sum.left = sum.dd - (sum.pp * sum.dq * sum.dq - 2.0 * sum.qp * sum.dq * dp + sum.qq * dp * dp) / det;
  return sum;
}

// Multiplies the line's samples with the step at the expected crossing `at_px`.
void Profiles::Multiply(std::size_t k, double at_px, double blur_px) {
  Line& line = measured_[k];
  line.used = false;
  if (!readable_[k] || std::fabs(at_px) > kHalf - 3.0) {
    return;
  }
  const double bend = 0.5 * blur_px * blur_px * lines_[k].curvature;
  const int place = static_cast<int>(std::lround((at_px - bend + kHalf) * kPhases));
  const int low = place / kPhases;
  const Step& step = steps_[static_cast<std::size_t>(place % kPhases)];
  const int first = low - half_ + 1;
  line.used = true;
  line.at_px = static_cast<double>(place) / kPhases - kHalf + bend;
  const int cut_low = std::max(0, -first);
  const int cut_high = std::min(2 * half_, kSamples - first);
  line.step = &step.whole;
  if (cut_low > 0 || cut_high < 2 * half_) {
    cut_[k] = Products(step, cut_low, cut_high);
    line.step = &cut_[k];
  }
  // Zeros pad the line beyond its ends.
  const float* y = &value_[k][static_cast<std::size_t>(first + kPad)];
  Four y1{}, yq{}, yd{}, yb{}, yz{}, yy{};
  for (int t = 0; t < 2 * half_; t += 4) {
    const auto j = static_cast<std::size_t>(t);
    const Four four = Load(y + t);
    const Four used = four * Load(&step.used[j]);
    y1 += used;
    yy += used * four;
    yq += four * Load(&step.q[j]);
    yd += four * Load(&step.density[j]);
    yb += four * Load(&step.wider[j]);
    yz += four * Load(&step.turn[j]);
  }
  const Sums& s = *line.step;
  const double c = shaded_ ? shade_[k] : 0.0;
  line.y = Total(y1) - c * s.z;
  line.yq = Total(yq) - c * s.zq;
  line.yd = Total(yd) - c * s.zd;
  line.yb = Total(yb) - c * s.zb;
  line.yy = Total(yy) - 2.0 * c * Total(yz) + c * c * s.zz;
}

void Profiles::Measure(const std::array<double, kMaxLines>& at_px,
                       const std::array<double, kMaxLines>& weight, double blur_px) {
  MakeSteps(blur_px);
  double contrast = 0.0;
  int lines = 0;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Multiply(k, at_px[k], blur_px);
    Line& line = measured_[k];
    line.levels = Levels{};
    if (!line.used) {
      continue;
    }
    const Sums& s = *line.step;
    line.levels = {s.qq, s.qp, s.pp, line.yq, line.y - line.yq};
    const double det = line.levels.Det();
    if (det > 0.0) {
      contrast += std::fabs(line.levels.Inside(det) - line.levels.Outside(det));
      ++lines;
    }
  }
  // The more noise, the more neighbours contribute to a line's levels.
  contrast = lines > 0 ? contrast / lines : 0.0;
  const double ratio = contrast / std::max(noise_, 0.1);
  const int neighbours = ratio > 25.0 ? 0 : ratio > 10.0 ? 1 : ratio > 4.0 ? 2 : 4;
  double blur_up = 0.0;
  double blur_down = 0.0;
  std::array<double, kMaxLines> variance;
  std::size_t variances = 0;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Edge& edge = edges_[k];
    edge = Edge{};
    const Line& line = measured_[k];
    if (!line.used) {
      continue;
    }
    Levels levels = line.levels;
    for (int j = 1; j <= neighbours; ++j) {
      for (const int other : {i - j, i + j}) {
        if (!closed_ && (other < 0 || other >= count_)) {
          continue;
        }
        const auto o = static_cast<std::size_t>((other + count_) % count_);
        levels.Add(weight[o], measured_[o].levels);
      }
    }
    const double det = levels.Det();
    if (!(det > 1e-6)) {
      continue;
    }
    const double outside = levels.Outside(det);
    const double step = levels.Inside(det) - outside;
    edge.step = step;
    if (std::fabs(step) < kMinContrast) {
      continue;
    }
    const Sums& s = *line.step;
    // Products with the residual y - outside - step q.
    const double dr = line.yd - outside * s.d - step * s.dq;
    const double rb = line.yb - outside * s.b - step * s.bq;
    const double rr = line.yy - 2.0 * (outside * line.y + step * line.yq) + outside * outside * s.n +
                      2.0 * outside * step * s.q + step * step * s.qq;
    if (!(s.left > 0.05 * s.dd)) {
      continue;
    }
    const double shift = std::clamp(dr / (step * s.left), -1.5 * blur_px, 1.5 * blur_px);
    edge.valid = true;
    edge.at_px = line.at_px + shift;
    edge.info = step * step * s.left;
    edge.contrast = std::fabs(step);
    edge.variance = std::max(rr - dr * dr / s.dd, 0.0) / (s.n - (neighbours == 0 ? 3.0 : 2.0));
    blur_up += weight[k] * step * rb;
    blur_down += weight[k] * step * step * s.bb;
    if (weight[k] > 0.2) {
      variance[variances++] = edge.variance;
    }
  }
  // The fitted levels absorb part of the blur's effect on the samples: about half remains.
  blur_change_ = blur_down > 0.0 ? std::clamp(1.6 * blur_up / blur_down, -0.5 * blur_px, 0.5 * blur_px) : 0.0;
  if (variances > 0) {
    const auto middle = variance.begin() + static_cast<std::ptrdiff_t>(variances / 2);
    std::nth_element(variance.begin(), middle, variance.begin() + static_cast<std::ptrdiff_t>(variances));
    noise_ = std::sqrt(*middle);
  }
}

}  // namespace fovea::vision
