// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/bench/common/html_text.hpp"
#include "tools/fovea/atlas/map.hpp"
#include "tools/fovea/robustness/text.hpp"

namespace fovea::robustness {
namespace {

using atlas::Figures;
using atlas::Spread;

constexpr double kWidth = 380.0;  // of the drawing, in its own units
constexpr double kAround = 12.0;
constexpr double kBarHeight = 11.0;
constexpr double kRowHeight = 50.0;
constexpr const char* kFills[]{"#8ec4de", "#0d3261"};  // low, high: a light and a dark one
constexpr double kRoomForText = 64.0;                  // at the right of the longest bar

// Styles of lines.
constexpr const char* kInk = "stroke=\"var(--ink)\"";
constexpr const char* kFaint = "stroke=\"var(--line)\"";
constexpr const char* kDashed = "stroke=\"var(--alarm)\" stroke-dasharray=\"5 4\"";
constexpr const char* kBlue = "stroke=\"#2f7ab3\" stroke-width=\"2\"";

std::string Line(double x0, double y0, double x1, double y1, const char* style) {
  return fmt::format(R"svg(<path d="M{:.1f} {:.1f}L{:.1f} {:.1f}" fill="none" {}/>)svg", x0, y0, x1, y1,
                     style);
}

std::string Text(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)svg", x, y, anchor,
                     bench::Escaped(text));
}

std::string Drawing(double height, const std::string& label, const std::string& inside) {
  return fmt::format(
      R"svg(<svg viewBox="0 0 {} {:.0f}" role="img" aria-label="{}" font-size="12" fill="var(--ink)" )svg"
      R"svg(style="width:100%;height:auto">{}</svg>)svg",
      kWidth, height, bench::Escaped(label), inside);
}

// The scale of an axis.
struct Scale {
  double begin = 0.0;  // on the drawing
  double per_unit = 1.0;
  double least = 0.0;  // value at `begin`

  [[nodiscard]] double At(double value) const { return begin + per_unit * (value - least); }
};

constexpr double kRounding = 1e-9;

// Labels below an axis up to `most`.
std::string Ticks(const Scale& scale, double most, double y, const std::string& name) {
  std::string text;
  const double step = atlas::TickStep(most - scale.least);
  for (int k = static_cast<int>(std::ceil(scale.least / step - kRounding));
       k * step <= most * (1.0 + kRounding); ++k) {
    text += Text(scale.At(k * step), y + 15.0, "middle", fmt::format("{:.4g}", k * step));
    text += Line(scale.At(k * step), y, scale.At(k * step), y + 4.0, kFaint);
  }
  return text + Text(0.5 * kWidth, y + 33.0, "middle", name);
}

// The axis on which all bars fit. It begins at 0, unless all values are far from it.
Scale ScaleOf(const Tornado& tornado, const Measure& measure, double& most) {
  constexpr double kFar = 0.5;      // of the largest value
  constexpr double kMargin = 0.15;  // of the range, below the least value
  most = 0.0;
  double least = std::numeric_limits<double>::infinity();
  const auto add = [&](const Figures& f) {
    if (const std::optional<Spread>& spread = f.*measure.spread) {
      most = std::max(most, spread->most);
      least = std::min(least, spread->median);
    }
  };
  add(tornado.base);
  add(tornado.all);
  for (const BarFigures& one : tornado.bars) {
    for (const auto& side : one.sides) {
      if (side) {
        add(side->stated);
      }
    }
  }
  if (most <= 0.0) {
    most = 1.0;
  }
  const double begin = least > kFar * most && least < most ? least - kMargin * (most - least) : 0.0;
  return {kAround, (kWidth - kAround - kRoomForText) / (most - begin), begin};
}

// One side's bar, from the median without errors, with its number.
std::string BarText(const Figures& f, const Measure& measure, double none, const Scale& scale, double top,
                    const char* fill) {
  const std::optional<Spread>& spread = f.*measure.spread;
  const int lost = f.FailedWithWay();
  std::string note = lost > 0 ? fmt::format("{} of {} failed", lost, f.WithWay()) : std::string();
  double end = scale.At(none);
  std::string text;
  if (spread) {
    const double from = std::min(none, spread->median);
    const double to = std::max(none, spread->median);
    text += fmt::format(
        R"svg(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{}" fill="{}" stroke="var(--ink)" stroke-width="0.5"/>)svg",
        scale.At(from), top, std::max(scale.per_unit * (to - from), 0.5), kBarHeight, fill);
    const double middle = top + 0.5 * kBarHeight;
    text += Line(scale.At(to), middle, scale.At(std::max(to, spread->most)), middle, kInk);
    end = scale.At(std::max(to, spread->most));
    note = fmt::format("{:.3g}{}{}", spread->median, note.empty() ? "" : ", ", note);
  }
  const bool fits = end + 5.0 + 7.0 * static_cast<double>(note.size()) < kWidth;
  return text + Text(fits ? end + 5.0 : kWidth - 2.0, top + kBarHeight - 1.5, fits ? "start" : "end", note);
}

// Axes for values over the size.
struct SizePlot {
  Scale x;
  double most_size = 1.0;
  double bottom = 190.0;
  double height = 170.0;
  double most = 1.0;  // value at the top

  SizePlot(const std::vector<SizeFigures>& sizes, double most_value) : most(most_value) {
    for (const SizeFigures& one : sizes) {
      most_size = std::max(most_size, one.size);
    }
    x = {52.0, (kWidth - 52.0 - 2.0 * kAround) / most_size, 0.0};
  }
  [[nodiscard]] double Y(double value) const { return bottom - height * value / most; }
  [[nodiscard]] std::string Frame(const std::string& y_name) const {
    std::string text = Line(x.At(0.0), bottom, x.At(most_size), bottom, kFaint) +
                       Line(x.At(0.0), bottom, x.At(0.0), bottom - height, kFaint) +
                       Ticks(x, most_size, bottom, "size of all differences, 1: as stated");
    const double step = atlas::TickStep(most);
    for (int k = 0; k * step <= most * (1.0 + kRounding); ++k) {
      text += Text(x.At(0.0) - 6.0, Y(k * step) + 4.0, "end", fmt::format("{:.4g}", k * step));
    }
    return text +
           fmt::format(
               R"svg(<text x="13" y="{0:.1f}" text-anchor="middle" transform="rotate(-90 13 {0:.1f})">{1}</text>)svg",
               bottom - 0.5 * height, bench::Escaped(y_name));
  }
  // A point with a line from `low` to `high`.
  [[nodiscard]] std::string Point(double size, double value, double low, double high) const {
    const double at = x.At(size);
    return Line(at, Y(low), at, Y(high), kBlue) +
           fmt::format(R"svg(<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="#2f7ab3"/>)svg", at, Y(value));
  }
};

constexpr double kPlotHeight = 232.0;

}  // namespace

const std::vector<Measure>& Measures() {
  static const std::vector<Measure> kMeasures{{"image error", "px", &Figures::error_px},
                                              {"position error", "mm", &Figures::error_mm},
                                              {"settling time", "s", &Figures::settle_s}};
  return kMeasures;
}

std::string TornadoChart(const Tornado& tornado, const Measure& measure) {
  double most = 0.0;
  const Scale scale = ScaleOf(tornado, measure, most);
  const auto& of_none = tornado.base.*measure.spread;
  const double none = of_none ? of_none->median : scale.least;
  const auto& of_all = tornado.all.*measure.spread;
  std::vector<const BarFigures*> bars = ByCost(tornado);
  const auto longest = [&](const BarFigures* one) {
    double value = 0.0;
    for (const auto& side : one->sides) {
      if (side && side->stated.*measure.spread) {
        value = std::max(value, std::fabs((side->stated.*measure.spread)->median - none));
      }
    }
    return value;
  };
  std::stable_sort(bars.begin(), bars.end(),
                   [&](const BarFigures* a, const BarFigures* b) { return longest(a) > longest(b); });
  double top = kAround;
  std::string text;
  for (const BarFigures* one : bars) {
    text +=
        Text(kAround, top + 12.0, "start", fmt::format("{}, {}", NameOf(one->bar), StatedRange(one->bar)));
    // The lines of the two medians do not cross the names.
    text += Line(scale.At(none), top + 15.0, scale.At(none), top + kRowHeight - 8.0, kInk);
    if (of_all) {
      text += Line(scale.At(of_all->median), top + 15.0, scale.At(of_all->median), top + kRowHeight - 8.0,
                   kDashed);
    }
    for (const Side side : kSides) {
      const auto k = static_cast<std::size_t>(side);
      if (one->sides.at(k)) {
        text += BarText(one->sides.at(k)->stated, measure, none, scale,
                        top + 17.0 + static_cast<double>(k) * (kBarHeight + 1.0), kFills[k]);
      }
    }
    top += kRowHeight;
  }
  text += Line(kAround, top, scale.At(most), top, kFaint);
  text += Ticks(scale, most, top, fmt::format("{} [{}]", measure.name, measure.unit));
  return Drawing(
      top + 42.0,
      fmt::format("Tornado chart of the {} for each quantity alone; the table below has the numbers",
                  measure.name),
      text);
}

std::string SuccessChart(const std::vector<SizeFigures>& sizes) {
  const SizePlot plot(sizes, 100.0);
  std::string text = plot.Frame("converged [%]");
  for (const SizeFigures& one : sizes) {
    const Figures& f = one.figures;
    text += plot.Point(one.size, f.WithWay() > 0 ? 100.0 * f.converged / f.WithWay() : 0.0,
                       100.0 * f.wilson_95[0], 100.0 * f.wilson_95[1]);
  }
  return Drawing(kPlotHeight, "Share of runs that converge over the size of all differences", text);
}

std::string MeasureChart(const std::vector<SizeFigures>& sizes, const Measure& measure) {
  double most = 0.0;
  for (const SizeFigures& one : sizes) {
    const std::optional<Spread>& spread = one.figures.*measure.spread;
    most = std::max(most, spread ? spread->most : 0.0);
  }
  const SizePlot plot(sizes, most > 0.0 ? most : 1.0);
  std::string text = plot.Frame(fmt::format("{} [{}]", measure.name, measure.unit));
  for (const SizeFigures& one : sizes) {
    if (const std::optional<Spread>& spread = one.figures.*measure.spread) {
      text += plot.Point(one.size, spread->median, spread->median, spread->most);
    }
  }
  return Drawing(kPlotHeight, fmt::format("The {} over the size of all differences", measure.name), text);
}

}  // namespace fovea::robustness
