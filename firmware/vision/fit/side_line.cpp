// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/fit/side_line.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/vision/fit/biweight.hpp"
#include "firmware/vision/fit/profiles.hpp"

namespace fovea::vision {
namespace {

constexpr std::size_t kLeastEdges = 3;
constexpr int kReweights = 4;
constexpr double kBent = 2.5;         // a larger median residual [sigma] means that the line is wrong
constexpr double kAgreeSigmas = 3.0;  // largest residual of an edge that agrees with a line,
constexpr double kAgreePx = 0.15;     // plus this
constexpr double kOnPx = 0.25;
constexpr std::size_t kTries = 10;  // edges whose pairs are tried

double OffOf(const SideEdge& edge, const SideLine& line) { return edge.at_px - line.a - line.b * edge.t; }

// Median of the edges' absolute residuals below `most` [sigma].
double MedianOff(std::span<const SideEdge> edges, const SideLine& line, double most) {
  std::array<double, Profiles::kMaxLines> sizes;
  std::size_t count = 0;
  for (const SideEdge& edge : edges) {
    const double size = std::fabs(OffOf(edge, line)) / std::sqrt(edge.variance);
    if (size < most) {
      sizes[count++] = size;
    }
  }
  if (count == 0) {
    return 0.0;
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sizes.begin(), middle, sizes.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

bool Agrees(const SideEdge& edge, const SideLine& line) {
  const double off = std::fabs(OffOf(edge, line));
  return off < kAgreePx + kAgreeSigmas * std::sqrt(edge.variance);
}

// Of the lines through two groups of neighbouring edges, the one with which most edges agree.
SideLine MostAgreed(std::span<const SideEdge> edges) {
  constexpr std::size_t kGroup = 3;  // a group is the median of so many neighbours
  SideLine best;
  std::array<SideEdge, kTries> tries;
  const std::size_t count = std::min(kTries, edges.size() / kGroup);
  for (std::size_t i = 0; i < count; ++i) {
    const auto group =
        edges.subspan(i * (edges.size() - kGroup) / std::max<std::size_t>(count - 1, 1), kGroup);
    std::array<SideEdge, kGroup> three;
    std::copy(group.begin(), group.end(), three.begin());
    std::nth_element(three.begin(), three.begin() + 1, three.end(),
                     [](const SideEdge& a, const SideEdge& b) { return a.at_px < b.at_px; });
    tries[i] = three[1];
  }
  std::ptrdiff_t most = -1;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      SideLine line;
      line.b = (tries[i].at_px - tries[j].at_px) / (tries[i].t - tries[j].t);
      line.a = tries[i].at_px - line.b * tries[i].t;
      const auto agree = std::count_if(edges.begin(), edges.end(),
                                       [&line](const SideEdge& edge) { return Agrees(edge, line); });
      if (agree > most) {
        most = agree;
        best = line;
      }
    }
  }
  return best;
}

bool IsOn(const SideEdge& edge, const SideLine& line) {
  return edge.rounded || std::fabs(OffOf(edge, line)) < kOnPx + kAgreeSigmas * std::sqrt(edge.variance);
}

// One round of weighted least squares. False if the sum of weights is too small.
bool Solve(std::span<SideEdge> edges, double limit, SideLine& line) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-12;
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  double chi2 = 0.0;
  double sum = 0.0;
  for (SideEdge& edge : edges) {
    edge.weight = 0.0;
    if (edge.left_out) {
      continue;
    }
    const double info = 1.0 / edge.variance;
    const double off = OffOf(edge, line);
    edge.weight = Biweight(off * std::sqrt(info), limit);
    const double w = edge.weight * info;
    normal(0, 0) += w;
    normal(0, 1) += w * edge.t;
    normal(1, 1) += w * edge.t * edge.t;
    right[0] += w * edge.at_px;
    right[1] += w * edge.at_px * edge.t;
    chi2 += w * off * off;
    sum += edge.weight;
  }
  normal(1, 0) = normal(0, 1);
  const Eigen::Matrix2d inverse = normal.inverse();
  if (sum < kLeastEdges || !inverse.allFinite()) {
    return false;
  }
  const Eigen::Vector2d ab = inverse * right;
  line.a = ab[0];
  line.b = ab[1];
  line.cov = std::max(chi2 / std::max(sum - 2.0, 1.0), 0.25) * inverse;
  line.middle = normal(0, 1) / normal(0, 0);
  line.spread = std::sqrt(std::max(normal(1, 1) / normal(0, 0) - line.middle * line.middle, 1e-4));
  return true;
}

// Leaves out runs of edges that are off the line, and `beside` edges on both sides. True if there are any.
bool LeaveOut(std::span<SideEdge> edges, int beside, const SideLine& line) {
  constexpr int kRun = 3;
  const int count = static_cast<int>(edges.size());
  bool any = false;
  int run = 0;
  for (int i = 0; i < count; ++i) {
    run = IsOn(edges[static_cast<std::size_t>(i)], line) ? 0 : run + 1;
    if (run < kRun) {
      continue;
    }
    any = true;
    for (int j = std::max(0, i - run + 1 - beside); j <= std::min(count - 1, i + beside); ++j) {
      edges[static_cast<std::size_t>(j)].left_out = true;
    }
  }
  return any;
}

}  // namespace

bool FitSideLine(std::span<SideEdge> edges, int beside, SideLine& line) {
  constexpr double kAll = 1e9;
  if (edges.size() < kLeastEdges) {
    return false;
  }
  double most = kAll;
  for (int reweight = 0; reweight < kReweights; ++reweight) {
    double median = MedianOff(edges, line, most);
    if (reweight == 1 && median > kBent && edges.size() >= 2 * kTries) {
      line = MostAgreed(edges);
      most = 2.0 * kBent;
      median = MedianOff(edges, line, most);
    }
    if (!Solve(edges, BiweightLimit(median), line)) {
      return false;
    }
  }
  for (int turn = 0; turn < 2 && LeaveOut(edges, beside, line); ++turn) {
    if (!Solve(edges, BiweightLimit(0.0), line)) {
      return false;
    }
  }
  int on = 0;
  for (SideEdge& edge : edges) {
    edge.off = !IsOn(edge, line);
    on += edge.off ? 0 : 1;
  }
  line.on = static_cast<double>(on) / static_cast<double>(edges.size());
  return true;
}

}  // namespace fovea::vision
