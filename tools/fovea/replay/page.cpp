// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/replay/page.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/report/report.hpp"

namespace fovea {
namespace {

using nlohmann::json;

constexpr std::size_t kMostBuckets = 1000;
constexpr std::size_t kFirstJoint = 2;  // column of the first joint, after speed and turn

// Six decimals are enough for a plot.
json Numbers(const std::vector<float>& values) {
  json list = json::array();
  for (const float value : values) {
    if (std::isfinite(value)) {
      list.push_back(std::stod(std::to_string(value)));
    } else {
      list.push_back(nullptr);
    }
  }
  return list;
}

}  // namespace

void ReplayPage::Add(const log::Tick& recorded, const log::Tick& replayed) {
  if (joints_ == 0) {
    start_ns_ = recorded.stamp_ns();
    joints_ = static_cast<std::size_t>(recorded.command().tau_size());
    recorded_.lines = replayed_.lines = report::Envelope(kFirstJoint + 2 * joints_, kMostBuckets);
  }
  const double t_s = 1e-9 * static_cast<double>(recorded.stamp_ns() - start_ns_);
  Add(recorded, t_s, recorded_);
  Add(replayed, t_s, replayed_);
}

void ReplayPage::Add(const log::Tick& tick, double t_s, Side& side) const {
  std::vector<float> row(kFirstJoint + 2 * joints_, std::nanf(""));
  const auto size_of = [&tick](int first) {
    return static_cast<float>(
        std::hypot(tick.v_bc_c_cmd(first), tick.v_bc_c_cmd(first + 1), tick.v_bc_c_cmd(first + 2)));
  };
  if (tick.v_bc_c_cmd_size() == 6) {
    row[0] = size_of(0);
    row[1] = size_of(3);
  }
  for (std::size_t i = 0; i < joints_; ++i) {
    const auto k = static_cast<int>(i);
    if (k < tick.dq_cmd_size() && k < tick.command().tau_size()) {
      row[kFirstJoint + i] = static_cast<float>(tick.dq_cmd(k));
      row[kFirstJoint + joints_ + i] = static_cast<float>(tick.command().tau(k));
    }
  }
  side.lines.Add(t_s, row);
  const std::string& mode = log::Mode_Name(tick.mode());
  const std::string name =
      tick.mode() == log::FAULT ? mode + ": " + log::FaultCause_Name(tick.fault()) : mode;
  if (side.modes.empty() || side.modes.back().name != name) {
    side.modes.push_back({t_s, name});
  }
}

std::string ReplayPage::Make(const std::string& log, const std::vector<std::string>& settings,
                             const flight::ReplayResult& result) const {
  const auto of = [this](const Side& side, const std::string& title) {
    json run;
    run["title"] = title;
    const report::Envelope::Rows rows = side.lines.rows();
    run["t_s"] = Numbers(rows.t_s);
    run["speed"] = Numbers(rows.columns[0]);
    run["turn"] = Numbers(rows.columns[1]);
    for (std::size_t i = 0; i < joints_; ++i) {
      run["dq_cmd"].push_back(Numbers(rows.columns[kFirstJoint + i]));
      run["tau"].push_back(Numbers(rows.columns[kFirstJoint + joints_ + i]));
    }
    for (const Mode& mode : side.modes) {
      run["modes"].push_back({{"t_s", mode.t_s}, {"mode", mode.name}});
    }
    return run;
  };
  const json recorded = of(recorded_, log);
  json replayed = of(replayed_, "Replay with the changes");
  replayed["settings"] = settings;
  replayed["changes"] = json::array();
  for (const flight::FieldChange& change : result.changes) {
    const auto seconds = [&result](std::int64_t stamp_ns) {
      return 1e-9 * static_cast<double>(stamp_ns - result.start_ns);
    };
    replayed["changes"].push_back({{"field", change.field},
                                   {"ticks", change.ticks},
                                   {"first_s", seconds(change.first_ns)},
                                   {"most", std::isfinite(change.most) ? json(change.most) : json(nullptr)},
                                   {"most_s", seconds(change.most_ns)}});
  }
  return report::ReportPage(config::ShareFolder() / "report", "replay.html")
      .Make("Replay of " + log, {recorded.dump(), replayed.dump()});
}

}  // namespace fovea
