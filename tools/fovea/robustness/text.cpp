// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "firmware/host/config/printed_table.hpp"
#include "tools/fovea/atlas/seed.hpp"

namespace fovea::robustness {
namespace {

using Json = nlohmann::ordered_json;
using atlas::Figures;
using atlas::Spread;

constexpr const char* kSideNames[]{"low", "high"};

int LostOf(const Figures& f) { return f.FailedWithWay(); }

double MedianOf(const std::optional<Spread>& spread) { return spread ? spread->median : 0.0; }

// What makes one side worse than another.
std::tuple<int, double> CostKey(const BarFigures& bar) {
  std::tuple<int, double> worst{0, 0.0};
  for (const auto& side : bar.sides) {
    if (side) {
      worst = std::max(worst, {LostOf(side->stated), MedianOf(side->stated.error_px)});
    }
  }
  return worst;
}

Json MarginJson(const Bar& bar, Side side, const Margin& margin) {
  Json json;
  json["borne"] = AmountOf(bar, side, margin.borne).number;
  json["lost"] = margin.lost ? Json(AmountOf(bar, side, *margin.lost).number) : Json(nullptr);
  json["borne_multiple"] = margin.borne;
  json["lost_multiple"] = margin.lost ? Json(*margin.lost) : Json(nullptr);
  json["larger_is_impossible"] = margin.is_end;
  json["why"] = margin.why;
  json["command"] = margin.command;
  return json;
}

Json BarJson(const BarFigures& one) {
  Json json;
  json["quantity"] = one.bar.quantity;
  json["part"] = one.bar.part;
  for (const Side side : kSides) {
    const auto k = static_cast<std::size_t>(side);
    if (!one.sides.at(k)) {
      json[kSideNames[k]] = nullptr;
      continue;
    }
    const Amount amount = AmountOf(one.bar, side, 1.0);
    Json& at = json[kSideNames[k]];
    at["stated"] = amount.number;
    at["unit"] = amount.unit;
    at["figures"] = Json::parse(atlas::ToJson(one.sides.at(k)->stated));
    at["margin"] =
        one.sides.at(k)->margin ? MarginJson(one.bar, side, *one.sides.at(k)->margin) : Json(nullptr);
  }
  return json;
}

std::string Dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

constexpr const char* kFigureColumns =
    "runs,with_way,converged,limit_violations,contact_runs,settle_s_median,settle_s_most,error_px_median,"
    "error_px_"
    "most,"
    "error_mm_median,error_mm_most,error_deg_median,error_deg_most";

std::string Numbers(const std::optional<Spread>& spread) {
  return spread ? fmt::format("{},{}", spread->median, spread->most) : std::string(",");
}

std::string FigureNumbers(const Figures& f) {
  return fmt::format("{},{},{},{},{},{},{},{},{}", f.runs, f.WithWay(), f.converged, f.limit_violations,
                     f.contact_runs, Numbers(f.settle_s), Numbers(f.error_px), Numbers(f.error_mm),
                     Numbers(f.error_deg));
}

// Two significant digits, without an exponent.
std::string Signed(double number) {
  constexpr double kWholeFrom = 10.0;
  if (number == 0.0) {
    return "0";
  }
  return std::fabs(number) < kWholeFrom ? fmt::format("{:+.2g}", number) : fmt::format("{:+.0f}", number);
}

// The end of a borne range.
std::string BorneEnd(const BarFigures& one, Side side) {
  const auto& at = one.sides.at(static_cast<std::size_t>(side));
  if (!at) {
    return "0";
  }
  const Margin& margin = *at->margin;
  const bool beyond = !margin.lost && !margin.is_end;
  return fmt::format("{}{}{}", beyond ? ">" : "", Signed(AmountOf(one.bar, side, margin.borne).number),
                     margin.is_end ? " (end)" : "");
}

bool HasMargin(const BarFigures& one) {
  return std::any_of(one.sides.begin(), one.sides.end(),
                     [](const auto& side) { return side && side->margin.has_value(); });
}

}  // namespace

std::string StatedRange(const Bar& bar) {
  const Amount low = AmountOf(bar, Side::kLow, 1.0);
  const Amount high = AmountOf(bar, Side::kHigh, 1.0);
  return fmt::format("{} to {}{}{}", Signed(low.number), Signed(high.number), high.unit.empty() ? "" : " ",
                     high.unit);
}

std::string BorneRange(const BarFigures& bar) {
  if (!HasMargin(bar)) {
    return "-";
  }
  const std::string unit = AmountOf(bar.bar, Side::kHigh, 1.0).unit;
  return fmt::format("{} to {}{}{}", BorneEnd(bar, Side::kLow), BorneEnd(bar, Side::kHigh),
                     unit.empty() ? "" : " ", unit);
}

std::string SuccessOf(const Figures& f) {
  return fmt::format("{} of {} ({:.3g} to {:.3g} %)", f.converged, f.WithWay(), 100.0 * f.wilson_95[0],
                     100.0 * f.wilson_95[1]);
}

std::string MedianAndMost(const std::optional<Spread>& spread) {
  return spread ? fmt::format("{:.2g}; {:.2g}", spread->median, spread->most) : std::string("-");
}

std::string CostOf(const BarFigures& bar) {
  std::string failed;
  double px = 0.0;
  double mm = 0.0;
  double settle = 0.0;
  for (const Side side : kSides) {
    const auto& at = bar.sides.at(static_cast<std::size_t>(side));
    if (!at) {
      continue;
    }
    const Figures& f = at->stated;
    if (LostOf(f) > 0) {
      failed += fmt::format("{}{} of {} failed at {}", failed.empty() ? "" : ", ", LostOf(f), f.runs,
                            Signed(AmountOf(bar.bar, side, 1.0).number));
    }
    px = std::max(px, MedianOf(f.error_px));
    mm = std::max(mm, MedianOf(f.error_mm));
    settle = std::max(settle, MedianOf(f.settle_s));
  }
  return failed.empty() ? fmt::format("{:.2g} px, {:.2g} mm, {:.1f} s", px, mm, settle) : failed;
}

std::vector<const BarFigures*> ByCost(const Tornado& tornado) {
  std::vector<const BarFigures*> bars;
  for (const BarFigures& one : tornado.bars) {
    bars.push_back(&one);
  }
  std::stable_sort(bars.begin(), bars.end(),
                   [](const BarFigures* a, const BarFigures* b) { return CostKey(*a) > CostKey(*b); });
  return bars;
}

std::string ToJson(const Spec& spec, const std::vector<SizeFigures>& sizes) {
  Json json;
  json["spec"] = spec.name;
  json["truth"] = Scaled(spec, 1.0);
  json["sizes"] = Json::array();
  for (const SizeFigures& one : sizes) {
    json["sizes"].push_back({{"size", one.size}, {"figures", Json::parse(atlas::ToJson(one.figures))}});
  }
  return Dump(json);
}

std::string ToJson(const Spec& spec, const std::vector<Tornado>& targets) {
  Json json;
  json["spec"] = spec.name;
  json["truth"] = Scaled(spec, 1.0);
  json["targets"] = Json::array();
  for (const Tornado& tornado : targets) {
    Json bars = Json::array();
    for (const BarFigures& one : tornado.bars) {
      bars.push_back(BarJson(one));
    }
    json["targets"].push_back({{"target", tornado.none.heading.target},
                               {"starts", tornado.starts},
                               {"none", Json::parse(atlas::ToJson(tornado.none))},
                               {"none_from_starts", Json::parse(atlas::ToJson(tornado.base))},
                               {"all", Json::parse(atlas::ToJson(tornado.all))},
                               {"alone", bars}});
  }
  return Dump(json);
}

std::string ToCsv(const std::vector<SizeFigures>& sizes) {
  std::string text = fmt::format("size,wilson_low,wilson_high,{}\n", kFigureColumns);
  for (const SizeFigures& one : sizes) {
    text += fmt::format("{},{},{},{}\n", one.size, one.figures.wilson_95[0], one.figures.wilson_95[1],
                        FigureNumbers(one.figures));
  }
  return text;
}

std::string ToCsv(const std::vector<Tornado>& targets) {
  std::string text = fmt::format("target,quantity,part,side,stated,unit,borne,lost,{}\n", kFigureColumns);
  for (const Tornado& tornado : targets) {
    const std::string& target = tornado.none.heading.target;
    text += fmt::format("{},none,,,,,,,{}\n", target, FigureNumbers(tornado.none));
    text += fmt::format("{},all,,,,,,,{}\n", target, FigureNumbers(tornado.all));
    for (const BarFigures& one : tornado.bars) {
      for (const Side side : kSides) {
        const auto k = static_cast<std::size_t>(side);
        const auto& at = one.sides.at(k);
        if (!at) {
          continue;
        }
        const auto number = [&](double multiple) {
          return fmt::format("{:.6g}", AmountOf(one.bar, side, multiple).number);
        };
        const bool lost = at->margin && at->margin->lost;
        text += fmt::format("{},{},{},{},{},{},{},{},{}\n", target, one.bar.quantity, one.bar.part,
                            kSideNames[k], number(1.0), AmountOf(one.bar, side, 1.0).unit,
                            at->margin ? number(at->margin->borne) : "",
                            lost ? number(*at->margin->lost) : "", FigureNumbers(at->stated));
      }
    }
  }
  return text;
}

std::string ToTable(const std::vector<SizeFigures>& sizes, const config::TextStyle& style) {
  config::PrintedTable table(style);
  for (const SizeFigures& one : sizes) {
    const Figures& f = one.figures;
    table.Row(fmt::format("size {:g}", one.size),
              fmt::format(
                  "converged {}; {} px, {} mm, {} s (median; most); {} limit violations, contacts in {} runs",
                  SuccessOf(f), MedianAndMost(f.error_px), MedianAndMost(f.error_mm),
                  MedianAndMost(f.settle_s), f.limit_violations, f.contact_runs),
              f.limit_violations > 0 ? config::Paint::kBad : config::Paint::kPlain);
  }
  return table.text();
}

std::string ToTable(const Tornado& tornado, const config::TextStyle& style) {
  config::PrintedTable table(style);
  const atlas::Heading& heading = tornado.none.heading;
  table.Row("target",
            fmt::format("{}, {} seed {}; starts of each quantity alone: {}", heading.target,
                        atlas::KindOfSeed(heading.seed, heading.servo), heading.seed, tornado.starts));
  for (const auto& [name, f] :
       {std::pair<const char*, const Figures&>{"none", tornado.none}, {"all together", tornado.all}}) {
    table.Row(name, fmt::format("converged {}; {} px, {} mm, {} s (median; most); {} limit violations, "
                                "contacts in {} runs",
                                SuccessOf(f), MedianAndMost(f.error_px), MedianAndMost(f.error_mm),
                                MedianAndMost(f.settle_s), f.limit_violations, f.contact_runs));
  }
  for (const BarFigures* one : ByCost(tornado)) {
    table.Row(NameOf(one->bar),
              fmt::format("{}: {}{}{}", StatedRange(one->bar), CostOf(*one),
                          HasMargin(*one) ? "; borne: " : "", HasMargin(*one) ? BorneRange(*one) : ""));
  }
  return table.text();
}

}  // namespace fovea::robustness
