// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/figures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "firmware/host/config/printed_table.hpp"
#include "tools/fovea/atlas/seed.hpp"

namespace fovea::atlas {
namespace {

using Json = nlohmann::ordered_json;

std::optional<Spread> SpreadOf(std::vector<double> values) {
  if (values.empty()) {
    return std::nullopt;
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {  // the least value that at least this share does not exceed
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return Spread{at(0.5), at(0.95), values.back()};
}

Json ToJson(const std::optional<Spread>& spread) {
  return spread ? Json({{"median", spread->median}, {"p95", spread->p95}, {"max", spread->most}})
                : Json(nullptr);
}

std::string ToText(const std::optional<Spread>& spread, const char* unit) {
  return spread ? fmt::format("{:.3g} median, {:.3g} p95, {:.3g} max {}", spread->median, spread->p95,
                              spread->most, unit)
                : std::string("-");
}

std::uint64_t DrawsOf(const Figures& f) {
  return std::accumulate(f.rejections.begin(), f.rejections.end(), static_cast<std::uint64_t>(f.runs));
}

void AddSampler(const Figures& f, config::PrintedTable& table) {
  table.Row("sampler", fmt::format("{} draws for {} starts with a path; rejected:", DrawsOf(f), f.runs));
  for (std::size_t i = 0; i < f.rejections.size(); ++i) {
    table.Row("", fmt::format("{:>9} {}: {}", f.rejections[i], kRejectionNames[i], kRejectionWords[i]));
  }
}

Json SamplerJson(const Figures& f) {
  Json rejections;
  for (std::size_t i = 0; i < f.rejections.size(); ++i) {
    rejections[kRejectionNames[i]] = f.rejections[i];
  }
  return {{"draws", DrawsOf(f)}, {"rejected", rejections}};
}

void AddTarget(const Figures& f, config::PrintedTable& table) {
  table.Row("target", fmt::format("{}, scenario {}, {} seed {}", f.heading.target, f.scenario,
                                  KindOfSeed(f.heading.seed, f.heading.servo), f.heading.seed));
}

}  // namespace

std::array<double, 2> Wilson95(int converged, int runs) {
  constexpr double kZ = 1.959963984540054;  // of 95 %
  const double n = runs;
  const double p = converged / n;
  const double middle = p + kZ * kZ / (2.0 * n);
  const double half = kZ * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  const double scale = 1.0 / (1.0 + kZ * kZ / n);
  return {std::max(scale * (middle - half), 0.0), std::min(scale * (middle + half), 1.0)};
}

std::vector<std::string> AssignmentsOf(const Heading& heading, const Start& start) {
  // This one comes first, so that the caller's assignments override it.
  std::vector<std::string> assignments{"safety.planes=[0,0,1,0.03]"};
  assignments.insert(assignments.end(), heading.assignments.begin(), heading.assignments.end());
  std::vector<std::string> q;
  for (const double value : start.q) {
    q.push_back(fmt::format("{:.4f}", value));
  }
  assignments.push_back(fmt::format("arm.q_start=[{}]", fmt::join(q, ",")));
  assignments.push_back(
      fmt::format("target.position=[{:.4f},{:.4f},{:.4f}]", start.p_BO.x(), start.p_BO.y(), start.p_BO.z()));
  assignments.push_back(fmt::format("target.rpy_deg=[{:.2f},{:.2f},{:.2f}]", start.rpy_deg[0],
                                    start.rpy_deg[1], start.rpy_deg[2]));
  return assignments;
}

std::string CommandOf(const Heading& heading, const std::string& scenario, const Row& row) {
  std::string command = fmt::format("fovea-sim run {} --seed {}", scenario, row.start.run_seed);
  for (const std::string& assignment : AssignmentsOf(heading, row.start)) {
    command += fmt::format(" --set '{}'", assignment);
  }
  return command;
}

Figures Summarise(const Heading& heading, const std::string& scenario, const std::map<int, Row>& rows,
                  int runs) {
  Figures f;
  f.heading = heading;
  f.scenario = scenario;
  std::vector<double> settle, px, mm, deg;
  const auto keep = [](const std::optional<double>& value, std::vector<double>& values) {
    if (value) {
      values.push_back(*value);
    }
  };
  for (const auto& [index, row] : rows) {
    if (index >= runs) {
      continue;
    }
    ++f.runs;
    f.converged += row.converged ? 1 : 0;
    f.limit_violations += row.limit_violations;
    f.contact_runs += row.contact_ticks > 0 ? 1 : 0;
    for (std::size_t i = 0; i < f.rejections.size(); ++i) {
      f.rejections[i] += row.start.rejections[i];
    }
    for (const auto& [name, used] : row.limits) {
      f.limits[name] = std::max(f.limits[name], used);
    }
    if (row.converged) {
      keep(row.settle_time_s, settle);
      keep(row.final_error_px, px);
      keep(row.final_error_mm, mm);
      keep(row.final_error_deg, deg);
    }
    if (!row.converged || row.limit_violations > 0) {
      f.failures.push_back({index, row.verdict, CommandOf(heading, scenario, row)});
    }
  }
  f.wilson_95 = f.runs > 0 ? Wilson95(f.converged, f.runs) : std::array<double, 2>{0.0, 1.0};
  f.settle_s = SpreadOf(std::move(settle));
  f.error_px = SpreadOf(std::move(px));
  f.error_mm = SpreadOf(std::move(mm));
  f.error_deg = SpreadOf(std::move(deg));
  return f;
}

std::string ToJson(const Figures& f) {
  Json failures = Json::array();
  for (const Failure& failure : f.failures) {
    failures.push_back({{"run", failure.index}, {"verdict", failure.verdict}, {"command", failure.command}});
  }
  Json json;
  json["target"] = f.heading.target;
  json["scenario"] = f.scenario;
  json["seed"] = f.heading.seed;
  json["seed_kind"] = KindOfSeed(f.heading.seed, f.heading.servo);
  json["set"] = f.heading.assignments;
  json["runs"] = f.runs;
  json["converged"] = f.converged;
  json["success_rate"] = f.runs > 0 ? Json(static_cast<double>(f.converged) / f.runs) : Json(nullptr);
  json["wilson_95"] = f.wilson_95;
  json["reached_goal"] = f.ReachedGoal();
  json["limit_violations"] = f.limit_violations;
  json["contact_runs"] = f.contact_runs;
  json["settle_time_s"] = ToJson(f.settle_s);
  json["final_error_px_rms"] = ToJson(f.error_px);
  json["final_error_mm"] = ToJson(f.error_mm);
  json["final_error_deg"] = ToJson(f.error_deg);
  json["limits"] = f.limits;
  json["sampler"] = SamplerJson(f);
  json["failures"] = failures;
  json["servo"] = f.heading.servo;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToTable(const Figures& f, const config::TextStyle& style) {
  config::PrintedTable table(style);
  AddTarget(f, table);
  table.Row("converged", fmt::format("{} of {}: {:.1f} %, between {:.1f} and {:.1f} % (Wilson, 95 %)",
                                     f.converged, f.runs, f.runs > 0 ? 100.0 * f.converged / f.runs : 0.0,
                                     100.0 * f.wilson_95[0], 100.0 * f.wilson_95[1]));
  table.Row("limit violations", fmt::format("{}", f.limit_violations),
            f.limit_violations > 0 ? config::Paint::kBad : config::Paint::kPlain);
  table.Row("settled after", ToText(f.settle_s, "s"));
  table.Row("image error", ToText(f.error_px, "px rms"));
  table.Row("position error", ToText(f.error_mm, "mm"));
  if (f.error_deg) {
    table.Row("orientation error", ToText(f.error_deg, "deg"));
  }
  std::string limits;
  for (const auto& [name, used] : f.limits) {
    limits += fmt::format("{}{} {:.1f} %", limits.empty() ? "" : ", ", name, 100.0 * used);
  }
  table.Row("limits used, at most", limits);
  table.Row("touched something", fmt::format("{} runs", f.contact_runs));
  AddSampler(f, table);
  std::string text = table.text();
  for (const Failure& failure : f.failures) {
    config::PrintedTable row(style);
    row.Row(fmt::format("failure, run {}", failure.index), failure.verdict, config::Paint::kBad);
    text += row.text() + fmt::format("    {}\n", failure.command);  // in one line, to be copied
  }
  return text;
}

std::string DrawsAsJson(const Figures& f) {
  Json json;
  json["target"] = f.heading.target;
  json["seed"] = f.heading.seed;
  json["seed_kind"] = KindOfSeed(f.heading.seed, f.heading.servo);
  json["starts"] = f.runs;
  json["sampler"] = SamplerJson(f);
  return json.dump(2) + "\n";
}

std::string DrawsAsTable(const Figures& f, const config::TextStyle& style) {
  config::PrintedTable table(style);
  AddTarget(f, table);
  AddSampler(f, table);
  return table.text();
}

}  // namespace fovea::atlas
