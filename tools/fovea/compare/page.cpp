// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/report/report.hpp"

namespace fovea::compare {
namespace {

using nlohmann::json;

// Four digits are enough for a plot.
json Numbers(const std::vector<float>& values) {
  json list = json::array();
  for (const float value : values) {
    list.push_back(std::isfinite(value) ? json(std::stod(fmt::format("{:.4g}", value))) : json(nullptr));
  }
  return list;
}

json Columns(const report::Envelope::Rows& rows, std::size_t from, std::size_t count) {
  json list = json::array();
  for (std::size_t i = from; i < from + count; ++i) {
    list.push_back(Numbers(rows.columns[i]));
  }
  return list;
}

}  // namespace

std::string MakePage(const std::string& log, const Comparison& comparison, const std::string& figures) {
  constexpr std::size_t kMostBuckets = 1000;
  const std::size_t joints = comparison.joints.size();
  report::Envelope torques(2 * joints, kMostBuckets);
  for (const Lack& window : comparison.windows) {
    const model::VecN explained = Explained(comparison.causes, window);
    std::vector<float> row(window.torque.begin(), window.torque.end());
    row.insert(row.end(), explained.begin(), explained.end());
    torques.Add(window.t_s, row);
  }
  json page = json::parse(figures);
  const report::Envelope::Rows deviations = comparison.deviations.rows();
  page["position_s"] = Numbers(deviations.t_s);
  page["position"] = Columns(deviations, 0, joints);
  const report::Envelope::Rows rows = torques.rows();
  page["torque_s"] = Numbers(rows.t_s);
  page["torque"] = Columns(rows, 0, joints);
  page["explained"] = Columns(rows, joints, joints);
  return report::ReportPage(config::ShareFolder() / "report", "difference.html")
      .Make("Comparison of " + log, {page.dump()});
}

}  // namespace fovea::compare
