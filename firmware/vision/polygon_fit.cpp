#include "fovea/vision/polygon_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fovea::vision {
namespace {

constexpr double kStartBlurPx = 1.8;
constexpr double kMinBlurPx = 0.45;
constexpr double kMaxBlurPx = 3.0;
constexpr int kRounds = 6;
constexpr double kStillPx = 0.003;
constexpr double kCornerPx = 4.0;  // edges nearer to a corner than this are rounded by it
constexpr int kMinLines = 6;       // on a side
constexpr double kMinScalePx = 0.03;
constexpr double kCommonPx = 0.01;  // what lens and light may move a side
constexpr double kGridPx = 0.06;    // and the pixels' grid and colours a corner, otherwise in each picture

double Biweight(double residual, double limit) {
  const double t = residual / limit;
  return std::fabs(t) >= 1.0 ? 0.0 : (1.0 - t * t) * (1.0 - t * t);
}

}  // namespace

bool PolygonFitter::ReadLines(const cv::Mat& image, const Intrinsics& in, const PolygonFit& fit) {
  const int n = fit.corners.count;
  count_ = 0;
  for (int k = 0; k < n; ++k) {
    const ImagePoint& p = fit.corners.corner[static_cast<std::size_t>(k)];
    const ImagePoint& q = fit.corners.corner[static_cast<std::size_t>((k + 1) % n)];
    Side& side = sides_[static_cast<std::size_t>(k)];
    const double du = q.u_px - p.u_px;
    const double dv = q.v_px - p.v_px;
    side.length = std::hypot(du, dv);
    if (!(side.length > 8.0) || side.length > 4.0 * in.width_px) {
      return false;
    }
    side.nu = dv / side.length;
    side.nv = -du / side.length;
    side.from = count_;
    const double skip = std::min(kCornerPx, 0.2 * side.length);
    const int lines =
        std::clamp(static_cast<int>(side.length - 2.0 * skip), kMinLines, Profiles::kMaxLines / n);
    for (int i = 0; i < lines; ++i) {
      const double way = skip + (side.length - 2.0 * skip) * i / (lines - 1);
      const auto line = static_cast<std::size_t>(count_++);
      lines_[line] = {p.u_px + way / side.length * du, p.v_px + way / side.length * dv, side.nu, side.nv,
                      0.0};
      place_[line] = 2.0 * way / side.length - 1.0;
    }
    side.to = count_;
  }
  profiles_.Read(image, in, lines_.data(), count_, false);
  at_px_.fill(0.0);
  return true;
}

bool PolygonFitter::FitSide(Side& side, PolygonFit& fit, double& rms2, double& noise2, double& weights) {
  constexpr int kReweights = 4;
  std::array<double, Profiles::kMaxLines> sizes;
  const double noise = std::max(profiles_.noise(), 0.3);
  const double quiet = std::min(noise, 1.5 * profiles_.quiet() + 0.5);
  // At first where the expected side is.
  side.a = 0.0;
  side.b = 0.0;
  for (int i = side.from; i < side.to; ++i) {
    side.a += at_px_[static_cast<std::size_t>(i)] / (side.to - side.from);
  }
  for (int reweight = 0; reweight < kReweights; ++reweight) {
    std::size_t count = 0;
    const auto residual_of = [&](int i) {
      return profiles_.edge(i).at_px - side.a - side.b * place_[static_cast<std::size_t>(i)];
    };
    const auto variance_of = [&](int i) {
      return noise * noise / profiles_.edge(i).info + kMinScalePx * kMinScalePx;
    };
    for (int i = side.from; i < side.to; ++i) {
      if (profiles_.edge(i).valid) {
        sizes[count++] = std::fabs(residual_of(i)) / std::sqrt(variance_of(i));
      }
    }
    if (count < kMinLines / 2) {
      return false;
    }
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(sizes.begin(), middle, sizes.begin() + static_cast<std::ptrdiff_t>(count));
    const double limit = 4.685 * std::max(1.4826 * *middle, 1.0);
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-12;
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double chi2 = 0.0;
    double sum = 0.0;
    for (int i = side.from; i < side.to; ++i) {
      const auto k = static_cast<std::size_t>(i);
      weight_[k] = 0.0;
      if (!profiles_.edge(i).valid) {
        continue;
      }
      const double info = 1.0 / variance_of(i);
      const double residual = residual_of(i);
      const double w = Biweight(residual * std::sqrt(info), limit);
      weight_[k] = w;
      const Eigen::Vector2d row(1.0, place_[k]);
      normal += w * info * row * row.transpose();
      right += w * info * profiles_.edge(i).at_px * row;
      chi2 += w * info * residual * residual;
      sum += w;
      if (reweight == kReweights - 1) {
        rms2 += w * residual * residual;
        noise2 += w * quiet * quiet / profiles_.edge(i).info;
        weights += w;
        fit.contrast += w * profiles_.edge(i).contrast;
        fit.seen += w > 0.2 ? 1.0 : 0.0;
      }
    }
    const Eigen::Matrix2d inverse = normal.inverse();
    if (sum < 3.0 || !inverse.allFinite()) {
      return false;
    }
    const Eigen::Vector2d line = inverse * right;
    side.a = line[0];
    side.b = line[1];
    side.cov = std::max(chi2 / std::max(sum - 2.0, 1.0), 0.25) * inverse;
    side.cov(0, 0) += kCommonPx * kCommonPx;
  }
  return true;
}

// Corners to where the sides meet now, and their covariance.
void PolygonFitter::MoveCorners(PolygonFit& fit) const {
  const int n = fit.corners.count;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, CornerFit::kMaxSize,
                                 CornerFit::kMaxSize>;
  Jacobian J = Jacobian::Zero(2 * n, 2 * n);  // of the corners by the sides' a, b
  Jacobian cov = Jacobian::Zero(2 * n, 2 * n);
  for (int k = 0; k < n; ++k) {
    const int before = (k + n - 1) % n;
    const Side& s = sides_[static_cast<std::size_t>(before)];  // ends here, t = 1
    const Side& e = sides_[static_cast<std::size_t>(k)];       // begins here, t = -1
    Eigen::Matrix2d normals;
    normals << s.nu, s.nv, e.nu, e.nv;
    const Eigen::Matrix2d inverse = normals.inverse();
    const Eigen::Vector2d move = inverse * Eigen::Vector2d(s.a + s.b, e.a - e.b);
    ImagePoint& corner = fit.corners.corner[static_cast<std::size_t>(k)];
    corner.u_px += move.x();
    corner.v_px += move.y();
    J.block<2, 1>(2 * k, 2 * before) += inverse.col(0);
    J.block<2, 1>(2 * k, 2 * before + 1) += inverse.col(0);
    J.block<2, 1>(2 * k, 2 * k) += inverse.col(1);
    J.block<2, 1>(2 * k, 2 * k + 1) -= inverse.col(1);
    cov.block<2, 2>(2 * k, 2 * k) = e.cov;
  }
  fit.corners.cov = J * cov * J.transpose();
  fit.corners.cov.diagonal().array() += kGridPx * kGridPx;
}

PolygonFit PolygonFitter::Fit(const cv::Mat& image, const Intrinsics& in, std::span<const ImagePoint> start) {
  PolygonFit fit;
  fit.corners.count = static_cast<int>(start.size());
  std::copy(start.begin(), start.end(), fit.corners.corner.begin());
  double blur = kStartBlurPx;
  weight_.fill(1.0);
  if (!ReadLines(image, in, fit)) {
    return fit;
  }
  for (int round = 0; round < kRounds; ++round) {
    profiles_.Measure(at_px_, weight_, blur);
    double rms2 = 0.0;
    double noise2 = 0.0;
    double weights = 0.0;
    fit.contrast = 0.0;
    fit.seen = 0.0;
    double moved = 0.0;
    double read = 0.0;
    for (int k = 0; k < fit.corners.count; ++k) {
      Side& side = sides_[static_cast<std::size_t>(k)];
      if (!FitSide(side, fit, rms2, noise2, weights)) {
        return fit;
      }
      for (int i = side.from; i < side.to; ++i) {
        const auto line = static_cast<std::size_t>(i);
        const double now = side.a + side.b * place_[line];
        moved = std::max(moved, std::fabs(now - at_px_[line]));
        read = std::max(read, std::fabs(now));
        at_px_[line] = now;
      }
    }
    fit.rms_px = std::sqrt(rms2 / std::max(weights, 1e-9));
    fit.noise_px = std::sqrt(noise2 / std::max(weights, 1e-9));
    fit.contrast /= std::max(weights, 1e-9);
    fit.quiet = profiles_.quiet();
    fit.seen /= count_;
    const double next = std::clamp(blur + profiles_.blur_change_px(), kMinBlurPx, kMaxBlurPx);
    const bool still = round >= 3 && std::fabs(next - blur) < 0.05 * blur && moved < kStillPx;
    blur = next;
    const bool last = still || round == kRounds - 1;
    if (last || read > 3.0) {
      MoveCorners(fit);
      if (last) {
        break;
      }
      if (!ReadLines(image, in, fit)) {
        return fit;
      }
    }
  }
  for (const ImagePoint& p : std::span(fit.corners.corner).first(start.size())) {
    if (!std::isfinite(p.u_px) || !std::isfinite(p.v_px)) {
      return fit;
    }
  }
  fit.converged =
      fit.corners.cov.allFinite() && RadiusOf(std::span(fit.corners.corner).first(start.size())) > 0.0;
  return fit;
}

}  // namespace fovea::vision
