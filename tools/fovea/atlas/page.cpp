// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/host/report/page_style.hpp"
#include "tools/bench/common/html_text.hpp"
#include "tools/fovea/atlas/map.hpp"
#include "tools/fovea/atlas/seed.hpp"

namespace fovea::atlas {
namespace {

using bench::Escaped;

std::string Tile(const char* name, const std::string& value, const char* unit, const std::string& note) {
  return fmt::format(
      "<div class=\"tile\"><dt>{}</dt><dd><span class=\"value\">{} <span class=\"unit\">{}</span></span>"
      "<span class=\"note\">{}</span></dd></div>",
      name, value, unit, note);
}

std::string SpreadTile(const char* name, const std::optional<Spread>& spread, const char* unit) {
  return spread ? Tile(name, fmt::format("{:.3g}", spread->median), unit,
                       fmt::format("median; 95 %: {:.3g}, most: {:.3g}", spread->p95, spread->most))
                : std::string();
}

std::string Verdict(const Figures& f) {
  return fmt::format(
      "<section id=\"verdict\"><div class=\"banner {}\"><div><p class=\"run-tag\">{} runs, {} seed {}, "
      "scenario "
      "{}</p><p class=\"verdict-word\">{} of {} with a way converged</p><p class=\"verdict-sentence\">The "
      "rate lies between {:.1f} and {:.1f} % (Wilson, 95 %); limits were exceeded in {} ticks. {} runs "
      "failed "
      "although a way leads to the goal. From {} starts no way was found{}.</p></div></div><dl "
      "class=\"tiles\">"
      "{}{}{}{}</dl></section>",
      f.ReachedGoal() ? "good" : "bad", f.runs, KindOfSeed(f.heading.seed, f.heading.servo), f.heading.seed,
      Escaped(f.scenario), f.converged, f.WithWay(), 100.0 * f.wilson_95[0], 100.0 * f.wilson_95[1],
      f.limit_violations, f.FailedWithWay(), f.without_way.size(),
      f.without_way.empty() ? "" : fmt::format("; {} of these held with goal_unreachable", f.held),
      SpreadTile("Settled after", f.settle_s, "s"), SpreadTile("Image error", f.error_px, "px rms"),
      SpreadTile("Position error", f.error_mm, "mm"), SpreadTile("Orientation error", f.error_deg, "deg"));
}

// The multiple of `cell` nearest to 0 that no value exceeds: upwards for `sign` 1, downwards for -1.
double Bound(const std::vector<MapPoint>& points, double MapPoint::*value, double cell, int sign) {
  double bound = 0.0;
  for (const MapPoint& point : points) {
    bound = sign > 0 ? std::max(bound, point.*value) : std::min(bound, point.*value);
  }
  return sign * std::max(std::ceil(sign * bound / cell), 1.0) * cell;
}

std::string Figure(const char* title, const std::string& drawing) {
  return fmt::format("<figure><h3>{}</h3>{}</figure>", title, drawing);
}

std::string Maps(const Figures& f, const std::map<int, Row>& rows) {
  constexpr double kCell = 0.1;  // [m]
  std::vector<MapPoint> picture;
  std::vector<MapPoint> above;
  std::vector<MapPoint> side;
  HeatScale scale{1e9, 0.0};
  const MapAxes picture_axes{"u [px]", "v [px]", 0.0, f.width_px, 0.0, f.height_px, f.width_px / 8.0, true};
  for (const auto& [index, row] : rows) {
    if (index >= f.runs) {
      continue;
    }
    MapPoint point;
    point.run = index;
    point.failed = !row.converged || row.limit_violations > 0;
    if (!point.failed) {
      point.heat = row.settle_time_s.value_or(0.0);
      scale.least = std::min(scale.least, point.heat);
      scale.most = std::max(scale.most, point.heat);
    }
    const auto at = [&](double x, double y) {
      point.x = x;
      point.y = y;
      return point;
    };
    const Start& start = row.start;
    picture.push_back(at(start.u_px, start.v_px));
    above.push_back(at(start.p_BO.x(), start.p_BO.y()));
    side.push_back(at(start.p_BO.z(), start.depth));
  }
  scale.least = std::min(scale.least, scale.most);
  const MapAxes above_axes{"x of B [m]",
                           "y of B [m]",
                           Bound(above, &MapPoint::x, kCell, -1),
                           Bound(above, &MapPoint::x, kCell, 1),
                           Bound(above, &MapPoint::y, kCell, -1),
                           Bound(above, &MapPoint::y, kCell, 1),
                           kCell};
  const MapAxes side_axes{"height over the table [m]",
                          "depth in the camera at the start [m]",
                          0.0,
                          Bound(side, &MapPoint::x, kCell, 1),
                          0.2,
                          0.9,
                          kCell};
  return fmt::format("<section><h2>Where runs began</h2><div class=\"columns\">{}{}{}</div>{}</section>",
                     Figure("The target in the first picture", HeatMap(picture, picture_axes, scale)),
                     Figure("The target from above", HeatMap(above, above_axes, scale)),
                     Figure("Its depth and height", HeatMap(side, side_axes, scale)),
                     HeatLegend(scale, "Colour: median settling time of a cell's runs [s]"));
}

std::string LimitTable(const Figures& f) {
  std::string rows;
  for (const auto& [name, used] : f.limits) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td class=\"number{}\">{:.2f} %</td></tr>", name,
                        used > 1.0 + 1e-9 ? " over" : "", 100.0 * used);
  }
  return fmt::format(
      "<section><h2>Limits</h2><table><thead><tr><th>limit</th><th class=\"number\">largest share used in "
      "any "
      "run</th></tr></thead><tbody>{}</tbody></table></section>",
      rows);
}

std::string SamplerTable(const Figures& f) {
  std::string rows;
  for (std::size_t i = 0; i < f.rejections.size(); ++i) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"number\">{}</td></tr>",
                        kRejectionNames[i], Escaped(kRejectionWords[i]), f.rejections[i]);
  }
  return fmt::format(
      "<section><h2>Rejected draws</h2><table><thead><tr><th>first reason</th><th></th><th "
      "class=\"number\">"
      "draws</th></tr></thead><tbody>{}</tbody></table></section>",
      rows);
}

// The line of a start's file.
std::string LineInWords(int line) { return line > 0 ? fmt::format(" (line {})", line) : std::string(); }

std::string WithoutWayTable(const Figures& f) {
  if (f.without_way.empty()) {
    return {};
  }
  std::string rows;
  for (const WithoutWay& one : f.without_way) {
    rows += fmt::format(
        "<tr><th class=\"brief\" scope=\"row\">{}{}</th><td>{}; it ended in {}<code class=\"listing\" "
        "style=\"display:block\">{}</code></td></tr>",
        one.index, LineInWords(one.line), Escaped(InWords(one.judgement)), Escaped(one.end),
        Escaped(one.command));
  }
  return fmt::format(
      "<section><h2>Starts without a way</h2><p>{}.</p><table><thead><tr><th class=\"brief\">run</th><th>"
      "search and end of the run</th></tr></thead><tbody>{}</tbody></table></section>",
      Escaped(NoWayInWords(f)), rows);
}

std::string FailureTable(const Figures& f) {
  if (f.failures.empty()) {
    return "<section><h2>Failures</h2><p>None.</p></section>";
  }
  std::string rows;
  for (const Failure& failure : f.failures) {
    rows += fmt::format(
        "<tr><th class=\"brief\" scope=\"row\">{0}{4}</th><td>{1}; {5}<code class=\"listing\" "
        "style=\"display:block\">{2}</code></td>"
        "<td class=\"brief\"><a href=\"{3}/eye-first.png\">first</a>, <a "
        "href=\"{3}/eye-last.png\">last</a></td>"
        "</tr>",
        failure.index, Escaped(failure.verdict), Escaped(failure.command), Escaped(failure.folder),
        LineInWords(failure.line), Escaped(failure.way));
  }
  return fmt::format(
      "<section><h2>Failures</h2><table><thead><tr><th class=\"brief\">run</th><th>verdict and command</th>"
      "<th class=\"brief\">pictures</th></tr></thead><tbody>{}</tbody></table></section>",
      rows);
}

}  // namespace

AtlasPage::AtlasPage(const std::filesystem::path& folder) : style_(report::PageStyle(folder)) {}

std::string AtlasPage::Wrap(const std::string& title, const std::string& main) const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>Fovea: atlas, "
      "{0}</title><style>{1}</style></head>\n"
      "<body><header class=\"head\"><p class=\"brand\"><span class=\"brand-mark\" "
      "aria-hidden=\"true\"></span>Fovea "
      "<span class=\"brand-sub\">atlas of "
      "runs</span></p><h1>{0}</h1></header>\n<main>{2}\n"
      "</main></body></html>\n",
      Escaped(title), style_, main);
}

std::string AtlasPage::Make(const Figures& figures, const std::map<int, Row>& rows) const {
  return Wrap(figures.heading.target,
              fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}", Verdict(figures), Maps(figures, rows),
                          DeviationsAsHtml(figures.deviations), FailureTable(figures),
                          WithoutWayTable(figures), LimitTable(figures), SamplerTable(figures)));
}

}  // namespace fovea::atlas
