// SPDX-License-Identifier: Apache-2.0
// The result as one self-contained HTML page, in the style of a run's report.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/bench/common/html_text.hpp"
#include "tools/bench/jitter/result.hpp"

namespace fovea::bench {
namespace {

// Drawings stretch to the page's width. Text is outside the drawings, at its own size.
constexpr const char* kStyle = R"css(
.hist { position: relative; height: 300px; margin: 10px 8px 26px 52px; border-left: 1px solid var(--axis);
  border-bottom: 1px solid var(--axis); }
.hist svg { position: absolute; inset: 0; width: 100%; height: 100%; overflow: visible; }
.hist path, .hist line { vector-effect: non-scaling-stroke; }
.hist .area { opacity: 0.14; stroke: none; }
.hist .edge { fill: none; stroke-width: 2; }
.hist .rule { stroke: var(--grid); stroke-width: 1; }
.hist span { position: absolute; font-size: 13px; color: var(--quiet); font-variant-numeric: tabular-nums;
  white-space: nowrap; line-height: 16px; }
.hist .x { top: calc(100% + 4px); transform: translateX(-50%); }
.hist .y { right: calc(100% + 6px); transform: translateY(-50%); }
.line-key { width: 26px; height: 0; border-top: 3px solid; flex: none; }
.hops { display: flex; height: 34px; border-radius: 5px; overflow: hidden; margin: 6px 0 12px; }
.hops div { min-width: 2px; }
.hop-key { width: 14px; height: 14px; border-radius: 3px; flex: none; }
td.number, th.number { white-space: nowrap; }
ul.legend + .wide { margin-top: 14px; }
@media (max-width: 560px) {
  .wide table { font-size: 12.5px; }
  .wide th, .wide td { padding: 6px 3px; font-size: inherit; }
  section { padding-left: 14px; padding-right: 14px; }
}
.limits li { margin: 4px 0 4px 18px; list-style: disc; }
)css";

constexpr std::array<const char*, 3> kLines{"var(--blue)", "var(--vermillion)", "var(--green)"};
constexpr std::array<const char*, 3> kDashes{"none", "6 4", "2 3"};
constexpr std::array<const char*, 5> kHopColours{"var(--axis)", "var(--sky)", "var(--blue)", "var(--orange)",
                                                 "var(--vermillion)"};

std::string Duration(double us) {
  if (us >= 10'000.0) {
    return fmt::format("{:.1f} ms", 1e-3 * us);
  }
  return us >= 100.0 ? fmt::format("{:.0f} us", us) : fmt::format("{:.3g} us", us);
}

std::string Tile(const char* name, const std::string& value, const std::string& note) {
  return fmt::format(
      "<div class=\"tile\"><dt>{}</dt><dd><span class=\"value\">{}</span><span class=\"note\">{}</span></dd>"
      "</div>",
      name, value, note);
}

// Both axes are logarithmic: counts from 0.5 up, durations over the decades that contain any.
class HistogramAxes {
 public:
  explicit HistogramAxes(const std::vector<Durations>& kinds) {
    double least = 1e9;
    double most = 1.0;
    std::int64_t top = 1;
    for (const Durations& kind : kinds) {
      for (const LogHistogram::Bin& bin : CountByLog(kind.us).bins) {
        least = std::min(least, std::max(bin.low, 1.0));
        most = std::max(most, bin.high);
        top = std::max(top, bin.count);
      }
    }
    first_decade_ = static_cast<int>(std::floor(std::log10(std::min(least, most))));
    last_decade_ = std::max(static_cast<int>(std::ceil(std::log10(most))), first_decade_ + 1);
    top_decade_ = std::max(static_cast<int>(std::ceil(std::log10(static_cast<double>(top)))), 1);
  }
  // X: share of the width from the left. Y: share of the height from the top.
  [[nodiscard]] double X(double us) const {
    const double decades = last_decade_ - first_decade_;
    return std::max((std::log10(std::max(us, 1e-9)) - first_decade_) / decades, 0.0);
  }
  [[nodiscard]] double Y(double count) const {
    const double least = std::log10(0.5);
    return count > 0.0 ? 1.0 - (std::log10(count) - least) / (top_decade_ - least) : 1.0;
  }
  [[nodiscard]] int first_decade() const { return first_decade_; }
  [[nodiscard]] int last_decade() const { return last_decade_; }
  [[nodiscard]] int top_decade() const { return top_decade_; }

 private:
  int first_decade_ = 0;
  int last_decade_ = 1;
  int top_decade_ = 1;
};

constexpr double kBox = 1000.0;  // width and height of a drawing, in its own units

std::string Steps(const HistogramAxes& axes, const Durations& kind) {
  std::string path;
  for (const LogHistogram::Bin& bin : CountByLog(kind.us).bins) {
    const double y = kBox * axes.Y(static_cast<double>(bin.count));
    if (path.empty()) {
      path = fmt::format("M{:.1f} {:.0f}", kBox * axes.X(bin.low), kBox);
    }
    path += fmt::format("V{:.1f}H{:.1f}", y, kBox * axes.X(bin.high));
  }
  return path.empty() ? path : path + fmt::format("V{:.0f}", kBox);
}

std::string AxisLabels(const HistogramAxes& axes) {
  std::string text;
  for (int decade = axes.first_decade(); decade <= axes.last_decade(); ++decade) {
    const double us = std::pow(10.0, decade);
    text += fmt::format("<span class=\"x\" style=\"left:{:.2f}%\">{}</span>", 100.0 * axes.X(us),
                        decade < 3 ? fmt::format("{:g} us", us) : fmt::format("{:g} ms", 1e-3 * us));
  }
  for (int decade = 0; decade <= axes.top_decade(); ++decade) {
    const double count = std::pow(10.0, decade);
    text +=
        fmt::format("<span class=\"y\" style=\"top:{:.2f}%\">{:.0f}</span>", 100.0 * axes.Y(count), count);
  }
  return text;
}

std::string Rules(const HistogramAxes& axes) {
  std::string text;
  for (int decade = axes.first_decade() + 1; decade <= axes.last_decade(); ++decade) {
    text += fmt::format("<line class=\"rule\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.0f}\"/>",
                        kBox * axes.X(std::pow(10.0, decade)), kBox);
  }
  for (int decade = 0; decade <= axes.top_decade(); ++decade) {
    text += fmt::format("<line class=\"rule\" x1=\"0\" x2=\"{1:.0f}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>",
                        kBox * axes.Y(std::pow(10.0, decade)), kBox);
  }
  return text;
}

// At most three kinds.
std::string Histogram(const char* title, const std::vector<Durations>& kinds) {
  const HistogramAxes axes(kinds);
  std::string paths;
  std::string legend;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::string steps = Steps(axes, kinds[k]);
    paths += fmt::format(
        "<path class=\"area\" fill=\"{0}\" d=\"{1}\"/><path class=\"edge\" stroke=\"{0}\" "
        "stroke-dasharray=\"{2}\" d=\"{1}\"><title>{3}</title></path>",
        kLines[k], steps, kDashes[k], Escaped(kinds[k].title));
    legend += fmt::format(
        "<li><span class=\"line-key\" style=\"border-color:{};border-top-style:{}\"></span>{}</li>",
        kLines[k], std::array{"solid", "dashed", "dotted"}[k], Escaped(kinds[k].title));
  }
  return fmt::format(
      "<figure><h3>{0}</h3><div class=\"hist\" role=\"img\" aria-label=\"{0}\"><svg viewBox=\"0 0 {1:.0f} "
      "{1:.0f}\" "
      "preserveAspectRatio=\"none\">{2}{3}</svg>{4}</div><ul class=\"legend plain\">{5}</ul></figure>",
      title, kBox, Rules(axes), paths, AxisLabels(axes), legend);
}

std::string Table(const char* title, const std::vector<Durations>& list, int digits,
                  const std::string& more) {
  std::string rows;
  for (const Durations& durations : list) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th>", Escaped(durations.title));
    for (const double p : {0.0, 0.5, 0.99, 0.999, 0.9999, 1.0}) {
      rows += fmt::format("<td class=\"number\">{:.{}f}</td>", Percentile(durations.us, p), digits);
    }
    rows += "</tr>";
  }
  return fmt::format(
      "<section><h2>{}</h2>{}<div class=\"scroll wide\"><table><thead><tr><th>us</th><th "
      "class=\"number\">min</th>"
      "<th class=\"number\">p50</th><th class=\"number\">p99</th><th class=\"number\">p99.9</th><th "
      "class=\"number\">p99.99</th><th class=\"number\">max</th></tr></thead><tbody>{}</tbody></table></div>"
      "</section>",
      title, more, rows);
}

std::string HopBar(const std::vector<Durations>& hops) {
  std::string bar;
  std::string legend;
  const double total = Percentile(hops.back().us, 0.5);
  for (std::size_t i = 0; i + 1 < hops.size() && i < kHopColours.size(); ++i) {
    const double median = Percentile(hops[i].us, 0.5);
    bar += fmt::format("<div style=\"flex:{:.3f} 0 0;background:{}\" title=\"{}: {}\"></div>",
                       total > 0.0 ? 100.0 * median / total : 1.0, kHopColours[i], hops[i].title,
                       Duration(median));
    legend += fmt::format("<li><span class=\"hop-key\" style=\"background:{}\"></span>{} {}</li>",
                          kHopColours[i], hops[i].title, Duration(median));
  }
  return fmt::format(
      "<p>The median age of a picture is {} when its torques are written. Exposure ({:g} ms) and read-out "
      "({:g} ms) are set by the benchmark's camera; the rest is measured.</p><div "
      "class=\"hops\">{}</div><ul class=\"legend plain\">{}</ul>",
      Duration(total), 1e-6 * static_cast<double>(kExposureNs), 1e-6 * static_cast<double>(kReadOutNs), bar,
      legend);
}

std::string Counts(const JitterResult& result) {
  std::string rows;
  for (const JitterCounts& counts : CountsOf(result)) {
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"number{}\">{}</td><td class=\"number\">{}</td><td "
        "class=\"number\">{}</td><td class=\"number\">{}</td></tr>",
        counts.name, counts.sum.overruns > 0 ? " over" : "", counts.sum.overruns, counts.sum.page_faults,
        counts.sum.voluntary_switches, counts.sum.involuntary_switches);
  }
  return fmt::format(
      "<section><h2>Counts</h2><div class=\"scroll\"><table><thead><tr><th></th><th "
      "class=\"number\">overruns</th>"
      "<th class=\"number\">page faults</th><th class=\"number\">voluntary switches</th><th "
      "class=\"number\">involuntary switches</th></tr></thead><tbody>{}</tbody></table></div></section>",
      rows);
}

std::string Verdict(const JitterResult& result, const std::vector<Durations>& loop) {
  const JitterVerdict verdict = Judge(result);
  std::string tiles;
  tiles += Tile("Wake-up of the servo, p99.9", Duration(Percentile(loop[0].us, 0.999)),
                "median " + Duration(Percentile(loop[0].us, 0.5)));
  for (const WakeRatio& wake : WakeRatios(result)) {
    tiles += Tile(
        ("Compared with " + wake.to).c_str(), fmt::format("{:.2f} times", wake.ratio.value),
        fmt::format("p99.9; 90 %: {:.2f} to {:.2f}; goal {:g}", wake.ratio.low, wake.ratio.high, kGoalRatio));
  }
  tiles += Tile("The tick takes", Duration(Percentile(loop[1].us, 0.5)),
                "median; p99.9 " + Duration(Percentile(loop[1].us, 0.999)));
  tiles += Tile("Worst response", Duration(Percentile(loop[3].us, 1.0)),
                "from the deadline until the torques are written");
  return fmt::format(
      "<section id=\"verdict\"><div class=\"banner {}\"><div><p class=\"run-tag\">{} s of each, load {}, "
      "policy "
      "{}</p><p class=\"verdict-word\">{}</p><p class=\"verdict-sentence\">{}</p></div></div><dl "
      "class=\"tiles\">{}</dl></section>",
      verdict.holds ? "good" : "bad", result.seconds, result.load, result.policy,
      verdict.holds ? "Keeps 1 kHz" : "Does not keep 1 kHz", verdict.words, tiles);
}

std::string Limits(const JitterResult& result) {
  std::string items;
  for (const std::string& limit : result.machine.limits) {
    items += "<li>" + Escaped(limit) + "</li>";
  }
  if (result.cyclictest.empty()) {
    items += "<li>cyclictest: " + Escaped(result.cyclictest_absent) + "</li>";
  }
  return fmt::format(
      "<section><h2>Limits of this machine</h2><p>{}, {} cores, {}.</p><ul "
      "class=\"limits\">{}</ul></section>",
      Escaped(result.machine.kernel), result.machine.cores, Escaped(result.machine.processor),
      items.empty() ? "<li>None found.</li>" : items);
}

}  // namespace

std::string JitterPage(const JitterResult& result, const std::string& style) {
  const std::vector<Durations> loop = LoopDurations(result);
  std::vector<Durations> wakes{loop.front()};
  wakes.insert(wakes.end(), loop.begin() + 4, loop.end());
  const std::vector<Durations> of_servo(loop.begin() + 1, loop.begin() + 4);
  const std::vector<Durations> hops = HopDurations(result);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>Fovea: "
      "jitter</title><style>{}{}</style></head>\n"
      "<body><header class=\"head\"><p class=\"brand\"><span class=\"brand-mark\" "
      "aria-hidden=\"true\"></span>Fovea <span class=\"brand-sub\">jitter of the servo loop</span></p>"
      "<h1>Does this machine keep 1 kHz?</h1></header>\n<main>{}\n{}\n<section><h2>Histograms</h2><div "
      "class=\"columns\">{}{}</div><p class=\"hint\">Both axes are logarithmic; each step is a quarter of an "
      "octave wide.</p></section>\n{}\n{}\n{}\n{}\n</main></body></html>\n",
      style, kStyle, Verdict(result, loop), Limits(result), Histogram("Wake-up latency", wakes),
      Histogram("The servo's tick", of_servo), Table("The loop", loop, 1, ""),
      Table("Stages of the tick", StageDurations(result), 2, ""),
      Table("From picture to torque", hops, 0, HopBar(hops)), Counts(result));
}

}  // namespace fovea::bench
