// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/deviations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/bench/common/html_text.hpp"

namespace fovea::atlas {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kClasses = 3;

std::optional<double> Median(std::vector<double> values) {
  if (values.empty()) {
    return std::nullopt;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

using Sample = std::pair<double, const Row*>;  // a deviation and its run

DeviationClass ClassOf(std::vector<Sample>::const_iterator begin, std::vector<Sample>::const_iterator end) {
  DeviationClass one;
  one.least = begin->first;
  one.most = (end - 1)->first;
  std::vector<double> px;
  std::vector<double> mm;
  for (auto sample = begin; sample != end; ++sample) {
    const Row& row = *sample->second;
    ++one.runs;
    if (row.converged) {
      ++one.converged;
      px.push_back(row.final_error_px.value_or(0.0));
      mm.push_back(row.final_error_mm.value_or(0.0));
    }
  }
  one.median_px = Median(std::move(px));
  one.median_mm = Median(std::move(mm));
  return one;
}

std::string Number(const std::optional<double>& value) {
  return value ? fmt::format("{:.3g}", *value) : std::string("-");
}

}  // namespace

std::vector<Deviation> DeviationsOf(const std::map<int, Row>& rows, int runs) {
  const auto end = rows.lower_bound(runs);
  std::map<std::pair<std::string, int>, Deviation> found;
  for (auto row = rows.begin(); row != end; ++row) {
    for (const Drawn& drawn : row->second.drawn) {
      found[{drawn.key, drawn.entry}] = {drawn.key, drawn.unit, drawn.entry, {}};
    }
  }
  std::vector<Deviation> deviations;
  for (auto& [key, deviation] : found) {
    std::vector<Sample> samples;
    for (auto row = rows.begin(); row != end; ++row) {
      const auto& list = row->second.drawn;
      const auto drawn = std::find_if(list.begin(), list.end(), [&](const Drawn& one) {
        return one.key == deviation.key && one.entry == deviation.entry;
      });
      samples.emplace_back(drawn == list.end() ? 0.0 : drawn->actual - drawn->believed, &row->second);
    }
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.first < b.first; });
    const std::size_t classes = std::min(kClasses, samples.size());
    for (std::size_t i = 0; i < classes; ++i) {
      const auto at = [&](std::size_t k) {
        return samples.cbegin() + static_cast<std::ptrdiff_t>(k * samples.size() / classes);
      };
      deviation.classes.push_back(ClassOf(at(i), at(i + 1)));
    }
    deviations.push_back(std::move(deviation));
  }
  return deviations;
}

Json DeviationsAsJson(const std::vector<Deviation>& deviations) {
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json list = Json::array();
  for (const Deviation& deviation : deviations) {
    Json classes = Json::array();
    for (const DeviationClass& one : deviation.classes) {
      classes.push_back({{"from", one.least},
                         {"to", one.most},
                         {"runs", one.runs},
                         {"converged", one.converged},
                         {"final_error_px_rms_median", or_null(one.median_px)},
                         {"final_error_mm_median", or_null(one.median_mm)}});
    }
    list.push_back(
        {{"key", deviation.key}, {"entry", deviation.entry}, {"unit", deviation.unit}, {"classes", classes}});
  }
  return list;
}

std::string DeviationsAsHtml(const std::vector<Deviation>& deviations) {
  std::string rows;
  for (const Deviation& deviation : deviations) {
    for (const DeviationClass& one : deviation.classes) {
      rows += fmt::format(
          "<tr><th scope=\"row\">{} {}</th><td class=\"number\">{:+.3g} to {:+.3g} {}</td><td "
          "class=\"number\">{} of "
          "{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>",
          bench::Escaped(deviation.key), deviation.entry, one.least, one.most, bench::Escaped(deviation.unit),
          one.converged, one.runs, Number(one.median_px), Number(one.median_mm));
    }
  }
  return rows.empty()
             ? rows
             : fmt::format(
                   "<section><h2>Results against each deviation</h2><p class=\"hint\">True less believed "
                   "value, in "
                   "three classes with equal numbers of runs. Errors: medians of the converged runs.</p><div "
                   "style=\"overflow-x:auto\" tabindex=\"0\" role=\"region\" aria-label=\"Results against "
                   "each "
                   "deviation\"><table><thead><tr><th scope=\"col\">quantity, entry</th><th scope=\"col\" "
                   "class=\"number\">deviation</th><th scope=\"col\" class=\"number\">converged</th><th "
                   "scope=\"col\" "
                   "class=\"number\">image [px]</th><th scope=\"col\" class=\"number\">position "
                   "[mm]</th></tr></thead>"
                   "<tbody>{}</tbody></table></div></section>",
                   rows);
}

}  // namespace fovea::atlas
