// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace fovea::atlas {
namespace {

constexpr double kWidth = 460.0;  // of the drawing, in its own units
constexpr double kLeft = 46.0;
constexpr double kBelow = 40.0;
constexpr double kAround = 10.0;
constexpr double kFromDark = 0.55;  // from this share of the scale on, text on a cell is white

// From light to dark, so that the map is readable without colours too.
std::string Colour(double share) {
  constexpr std::array<std::array<double, 3>, 4> kStops{
      {{236, 243, 247}, {142, 196, 222}, {47, 122, 179}, {13, 50, 97}}};
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const double t = at - static_cast<double>(i);
  const auto mix = [&](std::size_t k) {
    return static_cast<int>(std::lround((1.0 - t) * kStops[i][k] + t * kStops[i + 1][k]));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

double Share(double heat, const HeatScale& scale) {
  return scale.most > scale.least ? (heat - scale.least) / (scale.most - scale.least) : 0.0;
}

struct Cell {
  std::vector<double> heat;
  int failed = 0;
};

// Maps values of the axes to positions on the drawing.
struct Frame {
  const MapAxes& axes;
  double scale = 1.0;
  double height = 0.0;

  explicit Frame(const MapAxes& given) : axes(given) {
    scale = (kWidth - kLeft - kAround) / (axes.x_max - axes.x_min);
    height = scale * (axes.y_max - axes.y_min);
  }
  [[nodiscard]] double X(double x) const { return kLeft + scale * (x - axes.x_min); }
  [[nodiscard]] double Y(double y) const {
    return kAround + scale * (axes.y_down ? y - axes.y_min : axes.y_max - y);
  }
};

std::string CellText(const Frame& frame, std::pair<int, int> at, Cell cell, const HeatScale& scale) {
  const MapAxes& axes = frame.axes;
  const double x0 = axes.x_min + at.first * axes.cell;
  const double y0 = axes.y_min + at.second * axes.cell;
  const double x1 = std::min(x0 + axes.cell, axes.x_max);
  const double y1 = std::min(y0 + axes.cell, axes.y_max);
  const double left = frame.X(x0);
  const double top = std::min(frame.Y(y0), frame.Y(y1));
  const double width = frame.X(x1) - left;
  const double height = std::fabs(frame.Y(y1) - frame.Y(y0));
  double share = 0.0;
  std::string fill = "var(--soft)";
  if (!cell.heat.empty()) {
    const auto middle = cell.heat.begin() + static_cast<std::ptrdiff_t>(cell.heat.size() / 2);
    std::nth_element(cell.heat.begin(), middle, cell.heat.end());
    share = Share(*middle, scale);
    fill = Colour(share);
  }
  return fmt::format(
      R"svg(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}" stroke="var(--card)"/>)svg"
      R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="middle" font-size="11" fill="{}">{}</text>)svg",
      left, top, width, height, fill, left + 0.5 * width, top + 0.5 * height + 4.0,
      share >= kFromDark ? "#ffffff" : "#17202a", cell.heat.size() + static_cast<std::size_t>(cell.failed));
}

constexpr double kRounding = 1e-9;

int FirstTick(double least, double step) { return static_cast<int>(std::ceil(least / step - kRounding)); }

std::string Numbers(const Frame& frame) {
  const MapAxes& axes = frame.axes;
  const double bottom = kAround + frame.height;
  std::string text;
  const double x_step = TickStep(axes.x_max - axes.x_min);
  for (int k = FirstTick(axes.x_min, x_step); k * x_step <= axes.x_max + kRounding; ++k) {
    const double x = k * x_step;
    text += fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:.4g}</text>)svg", frame.X(x),
                        bottom + 15.0, x);
  }
  const double y_step = TickStep(axes.y_max - axes.y_min);
  for (int k = FirstTick(axes.y_min, y_step); k * y_step <= axes.y_max + kRounding; ++k) {
    const double y = k * y_step;
    text += fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:.4g}</text>)svg", kLeft - 6.0,
                        frame.Y(y) + 4.0, y);
  }
  text += fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)svg",
                      0.5 * (kLeft + kWidth - kAround), bottom + 33.0, axes.x_name);
  const double middle = kAround + 0.5 * frame.height;
  text += fmt::format(
      R"svg(<text x="12" y="{0:.1f}" text-anchor="middle" transform="rotate(-90 12 {0:.1f})">{1}</text>)svg",
      middle, axes.y_name);
  return fmt::format(R"svg(<g font-size="12" fill="var(--quiet)">{}</g>)svg", text);
}

}  // namespace

double TickStep(double range) {
  const double rough = range / 6.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= rough) {
      return step * power;
    }
  }
  return 10.0 * power;
}

std::string HeatMap(const std::vector<MapPoint>& points, const MapAxes& axes, const HeatScale& scale) {
  const Frame frame(axes);
  std::map<std::pair<int, int>, Cell> cells;
  std::string crosses;
  for (const MapPoint& point : points) {
    const double x = std::clamp(point.x, axes.x_min, axes.x_max - 1e-9);
    const double y = std::clamp(point.y, axes.y_min, axes.y_max - 1e-9);
    Cell& cell = cells[{static_cast<int>((x - axes.x_min) / axes.cell),
                        static_cast<int>((y - axes.y_min) / axes.cell)}];
    if (!point.failed) {
      cell.heat.push_back(point.heat);
      continue;
    }
    ++cell.failed;
    crosses += fmt::format(
        R"svg(<path d="M{0:.1f} {1:.1f}l8 8m0 -8l-8 8" stroke="var(--alarm)" stroke-width="3"/>)svg"
        R"svg(<text x="{2:.1f}" y="{3:.1f}" font-size="12" font-weight="700" fill="var(--alarm)" stroke="var(--card)" )svg"
        R"svg(stroke-width="3" paint-order="stroke">{4}</text>)svg",
        frame.X(x) - 4.0, frame.Y(y) - 4.0, frame.X(x) + 7.0, frame.Y(y) + 4.0, point.run);
  }
  std::string drawn;
  for (const auto& [at, cell] : cells) {
    drawn += CellText(frame, at, cell, scale);
  }
  return fmt::format(
      R"svg(<svg viewBox="0 0 {} {:.0f}" role="img" aria-label="{} and {}" style="width:100%;height:auto">)svg"
      R"svg(<rect x="{}" y="{}" width="{:.1f}" height="{:.1f}" fill="none" stroke="var(--line)"/>{}{}{}</svg>)svg",
      kWidth, kAround + frame.height + kBelow, axes.x_name, axes.y_name, kLeft, kAround,
      kWidth - kLeft - kAround, frame.height, drawn, crosses, Numbers(frame));
}

std::string HeatLegend(const HeatScale& scale, const std::string& name) {
  constexpr int kSteps = 6;
  std::string text = fmt::format("<p class=\"hint\">{}: ", name);
  for (int i = 0; i < kSteps; ++i) {
    const double share = static_cast<double>(i) / (kSteps - 1);
    text += fmt::format("<span style=\"background:{};color:{};padding:2px 9px\">{:.2g}</span>", Colour(share),
                        share >= kFromDark ? "#ffffff" : "#17202a",
                        scale.least + share * (scale.most - scale.least));
  }
  return text + ". The number in a cell is the count of runs that began there.</p>";
}

}  // namespace fovea::atlas
