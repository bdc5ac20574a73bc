// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/bench/common/html_text.hpp"

namespace fovea::contact {
namespace {

constexpr double kWidth = 460.0;  // of the drawing, in its own units
constexpr double kHeight = 300.0;
constexpr double kLeft = 52.0;
constexpr double kRight = 440.0;
constexpr double kTop = 14.0;
constexpr double kBottom = 246.0;
constexpr const char* kColours[kForces.size()]{"#8ec4de", "#4a93c4", "#1f5f99", "#0d2747"};  // by force
constexpr const char* kAlarm = "var(--alarm)";
// Alarms per hour at the ends of their logarithmic axis. The left end also stands for none.
constexpr double kFewest = 1.0;
constexpr double kMost = 10'000.0;

struct Point {
  double x = 0.0;  // 0 to 1
  double y = 0.0;
};

double X(double share) { return kLeft + (kRight - kLeft) * std::clamp(share, 0.0, 1.0); }
double Y(double share) { return kBottom - (kBottom - kTop) * std::clamp(share, 0.0, 1.0); }
double OnLog(double per_hour) {
  return std::log(std::max(per_hour, kFewest) / kFewest) / std::log(kMost / kFewest);
}
double OfThreshold(double threshold) { return threshold / ThresholdAt(kNumThresholds - 1); }

std::string Text(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)svg", x, y, anchor,
                     bench::Escaped(text));
}

std::string Path(const std::vector<Point>& points, const std::string& colour, bool is_dashed) {
  std::string d;
  for (const Point& point : points) {
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", X(point.x), Y(point.y));
  }
  return fmt::format(R"svg(<path d="{}" fill="none" stroke="{}" stroke-width="2"{}/>)svg", d, colour,
                     is_dashed ? R"svg( stroke-dasharray="5 4" opacity="0.75")svg" : "");
}

struct Tick {
  double at = 0.0;  // 0 to 1
  std::string label;
};

std::string Frame(const std::vector<Tick>& below, const std::vector<Tick>& beside, const std::string& x_name,
                  const std::string& y_name) {
  std::string text = fmt::format(R"svg(<path d="M{0} {1}V{2}H{3}" fill="none" stroke="var(--ink)"/>)svg",
                                 kLeft, kTop, kBottom, kRight);
  for (const Tick& tick : below) {
    text += Text(X(tick.at), kBottom + 16.0, "middle", tick.label);
  }
  for (const Tick& tick : beside) {
    text += fmt::format(R"svg(<path d="M{} {:.1f}H{}" fill="none" stroke="var(--line)"/>)svg", kLeft,
                        Y(tick.at), kRight) +
            Text(kLeft - 6.0, Y(tick.at) + 4.0, "end", tick.label);
  }
  return text + Text(0.5 * (kLeft + kRight), kBottom + 36.0, "middle", x_name) +
         Text(kLeft + 4.0, kTop - 3.0, "start", y_name);
}

std::string Drawing(const std::string& label, const std::string& inside) {
  return fmt::format(
      R"svg(<svg viewBox="0 0 {} {}" role="img" aria-label="{}" font-size="12" fill="var(--ink)" )svg"
      R"svg(style="width:100%;height:auto">{}</svg>)svg",
      kWidth, kHeight, bench::Escaped(label), inside);
}

std::vector<Tick> ShareTicks() {
  std::vector<Tick> ticks;
  for (const int percent : {0, 25, 50, 75, 100}) {
    ticks.push_back({0.01 * percent, std::to_string(percent)});
  }
  return ticks;
}

std::vector<Tick> ThresholdTicks() {
  std::vector<Tick> ticks;
  for (const int percent : {0, 10, 20, 30, 40}) {
    ticks.push_back({OfThreshold(0.01 * percent), std::to_string(percent)});
  }
  return ticks;
}

std::vector<Tick> AlarmTicks() {
  std::vector<Tick> ticks{{0.0, "none"}};
  for (double per_hour = 10.0 * kFewest; per_hour <= kMost; per_hour *= 10.0) {
    ticks.push_back({OnLog(per_hour), fmt::format("{:g}", per_hour)});
  }
  return ticks;
}

std::string DefaultLine(const Study& study) {
  return fmt::format(
      R"svg(<path d="M{0:.1f} {1}V{2}" fill="none" stroke="var(--alarm)" stroke-dasharray="2 3"/>)svg",
      X(OfThreshold(ThresholdAt(study.threshold))), kTop, kBottom);
}

}  // namespace

std::string RocChart(const Study& study) {
  std::string text =
      Frame(AlarmTicks(), ShareTicks(), "false alarms per hour of motion", "noticed pushes at the hand [%]");
  for (const Detector detector : {Detector::kTotal, Detector::kBoth}) {
    for (std::size_t k = 0; k < kForces.size(); ++k) {
      const auto& pushed = study.wrong.pushed.at(static_cast<std::size_t>(Place::kHand)).at(k);
      std::vector<Point> points;
      for (std::size_t i = 0; i < kNumThresholds; ++i) {
        points.push_back({OnLog(CountAlarms(study.wrong.quiet, detector, i).PerHour()),
                          Detect(pushed, detector, i).Share()});
      }
      text += Path(points, kColours[k], detector == Detector::kTotal);
      const Point& at = points.at(study.threshold);
      text += fmt::format(
          R"svg(<circle cx="{:.1f}" cy="{:.1f}" r="5" fill="{}" stroke="{}" stroke-width="2"/>)svg", X(at.x),
          Y(at.y), detector == Detector::kBoth ? kAlarm : "none", kColours[k]);
    }
  }
  return Drawing("Receiver operating characteristic with wrong beliefs; the tables have the numbers", text);
}

std::string DetectionChart(const Study& study, Place place) {
  std::string text =
      Frame(ThresholdTicks(), ShareTicks(), "threshold [% of a joint's torque]", "detected [%]") +
      DefaultLine(study);
  for (const Detector detector : {Detector::kTotal, Detector::kBoth}) {
    for (std::size_t k = 0; k < kForces.size(); ++k) {
      const auto& pushed = study.wrong.pushed.at(static_cast<std::size_t>(place)).at(k);
      std::vector<Point> points;
      for (std::size_t i = 0; i < kNumThresholds; ++i) {
        points.push_back({OfThreshold(ThresholdAt(i)), Detect(pushed, detector, i).Share()});
      }
      text += Path(points, kColours[k], detector == Detector::kTotal);
    }
  }
  return Drawing(fmt::format("Detected pushes at the {} over the threshold", Name(place)), text);
}

std::string AlarmChart(const Study& study) {
  std::string text =
      Frame(ThresholdTicks(), AlarmTicks(), "threshold [% of a joint's torque]", "false alarms per hour") +
      DefaultLine(study);
  for (const Detector detector : {Detector::kTotal, Detector::kBoth}) {
    for (const auto& [runs, colour] :
         {std::pair<const Runs*, const char*>{&study.right, "#2e7d32"}, {&study.wrong, "#b26a00"}}) {
      std::vector<Point> points;
      for (std::size_t i = 0; i < kNumThresholds; ++i) {
        points.push_back(
            {OfThreshold(ThresholdAt(i)), OnLog(CountAlarms(runs->quiet, detector, i).PerHour())});
      }
      text += Path(points, colour, detector == Detector::kTotal);
    }
  }
  return Drawing("False alarms per hour of motion over the threshold", text);
}

std::string ForceLegend() {
  std::string text;
  for (std::size_t k = 0; k < kForces.size(); ++k) {
    text += fmt::format("<span class=\"swatch\" style=\"background:{}\"></span> {:g} N ", kColours[k],
                        kForces.at(k));
  }
  return text;
}

}  // namespace fovea::contact
