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
  if (!f.heading.starts.empty()) {
    table.Row("sampler", fmt::format("{} given starts", f.runs));
    return;
  }
  table.Row("sampler", fmt::format("{} draws for {} starts; rejected:", DrawsOf(f), f.runs));
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

// E.g. "run 7", with the line of its start's file.
std::string NameOf(int index, int line) {
  return line > 0 ? fmt::format("run {}, line {}", index, line) : fmt::format("run {}", index);
}

Json LineJson(int line) { return line > 0 ? Json(line) : Json(nullptr); }

std::string EndInWords(const Row& row) {
  return row.end_reason.empty() ? row.end_mode : fmt::format("{}, {}", row.end_mode, row.end_reason);
}

// Adds a run that did not converge, or exceeded a limit.
void AddFailed(const Row& row, const std::string& command, const std::map<int, Judgement>& judgements,
               Figures& f) {
  const auto judged = judgements.find(row.index);
  const bool has_way = row.converged || judged == judgements.end() || judged->second.has_way;
  Failure failure{row.index, row.start.line, row.verdict, "", command, RunFolder(row.case_name, row.index)};
  if (!has_way) {
    f.without_way.push_back({row.index, row.start.line, judged->second, EndInWords(row), command});
    if (row.HeldAsUnreachable()) {
      ++f.held;
      return;
    }
    failure.way = InWords(judged->second) + ", so the run has to end in Hold with goal_unreachable";
  } else if (judged != judgements.end()) {
    failure.way = InWords(judged->second);
  } else {
    failure.way = row.converged ? "it converged" : "a way exists: another run converged from this start";
  }
  f.failures.push_back(failure);
}

Json WithoutWayJson(const Figures& f) {
  Json runs = Json::array();
  for (const WithoutWay& one : f.without_way) {
    runs.push_back({{"run", one.index},
                    {"line", LineJson(one.line)},
                    {"draws", one.judgement.draws},
                    {"goal_postures", one.judgement.goals},
                    {"end", one.end},
                    {"command", one.command}});
  }
  return {{"runs", f.without_way.size()}, {"held_with_goal_unreachable", f.held}, {"starts", runs}};
}

void AddTarget(const Figures& f, config::PrintedTable& table) {
  table.Row("target", fmt::format("{}, scenario {}, {} seed {}", f.heading.target, f.scenario,
                                  KindOfSeed(f.heading.seed, f.heading.servo), f.heading.seed));
}

}  // namespace

std::string NoWayInWords(const Figures& f) {
  const int runs = static_cast<int>(f.without_way.size());
  return f.held == runs ? fmt::format("{}, all held with goal_unreachable", runs)
                        : fmt::format("{}, only {} held with goal_unreachable", runs, f.held);
}

std::array<double, 2> Wilson95(int converged, int runs) {
  constexpr double kZ = 1.959963984540054;  // of 95 %
  const double n = runs;
  const double p = converged / n;
  const double middle = p + kZ * kZ / (2.0 * n);
  const double half = kZ * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  const double scale = 1.0 / (1.0 + kZ * kZ / n);
  return {std::max(scale * (middle - half), 0.0), std::min(scale * (middle + half), 1.0)};
}

std::vector<std::string> AssignmentsOf(const Heading& heading, const std::vector<std::string>& truth,
                                       const Start& start) {
  std::vector<std::string> assignments{fmt::format("run.settled_s={}", kSettledS),
                                       fmt::format("run.duration_s={}", kMostS)};
  for (const auto& more : {SceneAssignments(heading.assignments), truth}) {
    assignments.insert(assignments.end(), more.begin(), more.end());
  }
  std::vector<std::string> q;
  for (const double value : start.q) {
    q.push_back(fmt::format("{:.6g}", value));
  }
  assignments.push_back(fmt::format("arm.q_start=[{}]", fmt::join(q, ",")));
  assignments.push_back(
      fmt::format("target.position=[{:.6g},{:.6g},{:.6g}]", start.p_BO.x(), start.p_BO.y(), start.p_BO.z()));
  assignments.push_back(fmt::format("target.rpy_deg=[{:.6g},{:.6g},{:.6g}]", start.rpy_deg[0],
                                    start.rpy_deg[1], start.rpy_deg[2]));
  if (start.goal) {
    assignments.push_back(fmt::format("servo.goal=[{}]", fmt::join(start.goal->xyz, ",")));
    assignments.push_back(fmt::format("servo.goal_rpy_deg=[{}]", fmt::join(start.goal->rpy_deg, ",")));
  }
  return assignments;
}

std::string CommandOf(const Heading& heading, const std::string& scenario, const Row& row) {
  std::string command = fmt::format("fovea-sim run {} --seed {}", scenario, row.start.run_seed);
  for (const std::string& assignment : AssignmentsOf(heading, row.truth, row.start)) {
    command += fmt::format(" --set '{}'", assignment);
  }
  return command;
}

std::string RunFolder(const std::string& case_name, int index) {
  return fmt::format("runs/{}{}{:04}", case_name, case_name.empty() ? "" : ".", index);
}

Figures Summarise(const Heading& heading, const std::string& scenario, const std::map<int, Row>& rows,
                  const std::map<int, Judgement>& judgements, int runs) {
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
    f.without_result += row.limits.empty() ? 1 : 0;
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
      AddFailed(row, CommandOf(heading, scenario, row), judgements, f);
    }
  }
  f.deviations = DeviationsOf(rows, runs);
  f.wilson_95 = f.WithWay() > 0 ? Wilson95(f.converged, f.WithWay()) : std::array<double, 2>{0.0, 1.0};
  f.settle_s = SpreadOf(std::move(settle));
  f.error_px = SpreadOf(std::move(px));
  f.error_mm = SpreadOf(std::move(mm));
  f.error_deg = SpreadOf(std::move(deg));
  return f;
}

std::string ToJson(const Figures& f) {
  Json failures = Json::array();
  for (const Failure& failure : f.failures) {
    failures.push_back({{"run", failure.index},
                        {"line", LineJson(failure.line)},
                        {"verdict", failure.verdict},
                        {"way", failure.way},
                        {"command", failure.command}});
  }
  Json json;
  json["target"] = f.heading.target;
  json["scenario"] = f.scenario;
  json["seed"] = f.heading.seed;
  json["seed_kind"] = KindOfSeed(f.heading.seed, f.heading.servo);
  json["set"] = f.heading.assignments;
  json["truth"] = f.heading.truth;
  json["runs"] = f.runs;
  json["converged"] = f.converged;
  json["with_way"] = f.WithWay();
  json["failed_with_way"] = f.FailedWithWay();
  json["without_way"] = WithoutWayJson(f);
  json["success_rate"] =
      f.WithWay() > 0 ? Json(static_cast<double>(f.converged) / f.WithWay()) : Json(nullptr);
  json["wilson_95"] = f.wilson_95;
  json["reached_goal"] = f.ReachedGoal();
  json["limit_violations"] = f.limit_violations;
  json["contact_runs"] = f.contact_runs;
  json["settle_time_s"] = ToJson(f.settle_s);
  json["final_error_px_rms"] = ToJson(f.error_px);
  json["final_error_mm"] = ToJson(f.error_mm);
  json["final_error_deg"] = ToJson(f.error_deg);
  json["limits"] = f.limits;
  json["deviations"] = DeviationsAsJson(f.deviations);
  json["sampler"] = SamplerJson(f);
  json["failures"] = failures;
  json["servo"] = f.heading.servo;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToTable(const Figures& f, const config::TextStyle& style) {
  config::PrintedTable table(style);
  AddTarget(f, table);
  table.Row("runs", fmt::format("{}: {} converged, {} failed with a way, {} without a way", f.runs,
                                f.converged, f.FailedWithWay(), f.without_way.size()));
  table.Row("converged",
            fmt::format("{} of {} with a way: {:.1f} %, between {:.1f} and {:.1f} % (Wilson, 95 %)",
                        f.converged, f.WithWay(), f.WithWay() > 0 ? 100.0 * f.converged / f.WithWay() : 0.0,
                        100.0 * f.wilson_95[0], 100.0 * f.wilson_95[1]));
  if (!f.without_way.empty()) {
    table.Row("no way", NoWayInWords(f),
              f.held < static_cast<int>(f.without_way.size()) ? config::Paint::kBad : config::Paint::kPlain);
  }
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
  const auto add_run = [&](const std::string& name, const std::string& words, config::Paint paint,
                           const std::string& command) {
    config::PrintedTable row(style);
    row.Row(name, words, paint);
    text += row.text() + fmt::format("    {}\n", command);  // in one line, to be copied
  };
  for (const Failure& failure : f.failures) {
    add_run("failure, " + NameOf(failure.index, failure.line),
            fmt::format("{}; {}", failure.verdict, failure.way), config::Paint::kBad, failure.command);
  }
  for (const WithoutWay& one : f.without_way) {
    add_run("no way, " + NameOf(one.index, one.line),
            fmt::format("{}; it ended in {}", InWords(one.judgement), one.end), config::Paint::kPlain,
            one.command);
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
