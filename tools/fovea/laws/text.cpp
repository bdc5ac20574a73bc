// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/laws/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/terminal.hpp"
#include "tools/fovea/atlas/figures.hpp"

namespace fovea::laws {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kHead = R"(# Visual laws compared

Printed by `fovea atlas --laws --markdown`. Each law (`servo.law`, [what they are](../firmware/README.md#four-targets)) runs from
the same starts, under the same limits, with `servo.plans=false`: otherwise a plan of all joints takes over far from the goal,
whatever the law. The four canonical tasks are those of Gans, Hutchinson and Corke (Performance tests for visual servo control
systems, IJRR 2003). The exit code is 1 if a run exceeded a limit or touched anything.

A cell has the time until the picture's error stays below 2 % of the first; the camera's largest distance from the straight
line between the ends of its way; and the largest error in the picture. **no**: the goal was not reached within 15 s.

)";

std::optional<double> Median(std::vector<double> values) {
  if (values.empty()) {
    return std::nullopt;
  }
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::string Number(const std::optional<double>& value, double scale, int digits, const char* unit) {
  return value ? fmt::format("{:.{}f} {}", scale * *value, digits, unit) : std::string("-");
}

std::string Cell(const atlas::Row& row) {
  const std::string way = fmt::format("{}, {}", Number(row.camera_excursion_m, 1e3, 0, "mm"),
                                      Number(row.error_px_max, 1.0, 0, "px"));
  return row.converged ? fmt::format("{}, {}", Number(row.settle_time_s, 1.0, 2, "s"), way)
                       : fmt::format("**no**, {}", way);
}

std::string Row(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string Canonical(const TargetStudy& target, const std::vector<std::string>& laws) {
  std::vector<std::string> head{"start"};
  head.insert(head.end(), laws.begin(), laws.end());
  std::string text = Row(head) + Row(std::vector<std::string>(head.size(), "---"));
  for (std::size_t i = 0; i < target.tasks.tasks.size(); ++i) {
    const Task& task = target.tasks.tasks[i];
    if (task.is_random) {
      break;
    }
    std::vector<std::string> cells{task.name};
    for (const std::string& law : laws) {
      cells.push_back(Cell(target.rows.at(law).at(i)));
    }
    text += Row(cells);
  }
  return text;
}

std::string Random(const TargetStudy& target, const std::vector<std::string>& laws) {
  std::string text =
      "| law | reached the goal | between (95 %) | settled after, median | camera's excursion, median |\n"
      "|---|---|---|---|---|\n";
  for (const std::string& law : laws) {
    const OnRandomStarts random = OnRandom(target, law);
    const auto interval = atlas::Wilson95(random.converged, random.runs);
    text += fmt::format("| {} | {} of {} | {:.1f} to {:.1f} % | {} | {} |\n", law, random.converged,
                        random.runs, 100.0 * interval[0], 100.0 * interval[1],
                        Number(random.settle_s, 1.0, 2, "s"), Number(random.excursion_m, 1e3, 0, "mm"));
  }
  return text;
}

// Each run that exceeded a limit or touched something, on a line of its own.
std::string OffendersInWords(const Study& study) {
  std::string text;
  for (const TargetStudy& target : study.targets) {
    for (const std::string& law : study.laws) {
      for (std::size_t i = 0; i < target.tasks.tasks.size(); ++i) {
        const atlas::Row& row = target.rows.at(law).at(i);
        if (row.limit_violations > 0 || row.contact_ticks > 0) {
          text += fmt::format(
              "- **{}, {}, {}**: a limit exceeded or something touched in {} ticks, {} of them contacts; "
              "{}\n",
              target.target, law, target.tasks.tasks[i].name, row.limit_violations, row.contact_ticks,
              row.verdict);
        }
      }
    }
  }
  return text.empty() ? "No run exceeded a limit or touched anything.\n" : text;
}

}  // namespace

OnRandomStarts OnRandom(const TargetStudy& study, const std::string& law) {
  OnRandomStarts random;
  std::vector<double> settle;
  std::vector<double> excursion;
  for (std::size_t i = 0; i < study.tasks.tasks.size(); ++i) {
    if (!study.tasks.tasks[i].is_random) {
      continue;
    }
    const atlas::Row& row = study.rows.at(law).at(i);
    ++random.runs;
    random.converged += row.converged ? 1 : 0;
    if (row.converged && row.settle_time_s) {
      settle.push_back(*row.settle_time_s);
    }
    if (row.camera_excursion_m) {
      excursion.push_back(*row.camera_excursion_m);
    }
  }
  random.settle_s = Median(settle);
  random.excursion_m = Median(excursion);
  return random;
}

std::string ToTable(const Study& study) {
  config::PrintedTable table(config::StyleOf(STDOUT_FILENO));
  for (const TargetStudy& target : study.targets) {
    for (const std::string& law : study.laws) {
      int canonical = 0;
      int reached = 0;
      for (std::size_t i = 0; i < target.tasks.tasks.size(); ++i) {
        canonical += target.tasks.tasks[i].is_random ? 0 : 1;
        reached += !target.tasks.tasks[i].is_random && target.rows.at(law).at(i).converged ? 1 : 0;
      }
      const OnRandomStarts random = OnRandom(target, law);
      table.WholeRow(fmt::format("{}, {}", target.target, law),
                     fmt::format("canonical {} of {}; random {} of {}, settled after {}", reached, canonical,
                                 random.converged, random.runs, Number(random.settle_s, 1.0, 2, "s")));
    }
  }
  table.WholeRow("limits",
                 KeepsLimits(study) ? "none exceeded, nothing touched" : "exceeded, or something touched");
  return table.text();
}

std::string ToJson(const Study& study) {
  Json json{{"seed", study.seed}, {"keeps_limits", KeepsLimits(study)}, {"targets", Json::object()}};
  for (const TargetStudy& target : study.targets) {
    Json& of_target = json["targets"][target.target];
    of_target["skipped"] = target.tasks.skipped;
    for (const std::string& law : study.laws) {
      for (std::size_t i = 0; i < target.tasks.tasks.size(); ++i) {
        const atlas::Row& row = target.rows.at(law).at(i);
        const auto number = [](const std::optional<double>& value) {
          return value ? Json(*value) : Json(nullptr);
        };
        of_target["laws"][law][target.tasks.tasks[i].name] = {
            {"converged", row.converged},
            {"verdict", row.verdict},
            {"settle_time_s", number(row.settle_time_s)},
            {"camera_path_m", number(row.camera_path_m)},
            {"camera_excursion_m", number(row.camera_excursion_m)},
            {"error_px_max", number(row.error_px_max)},
            {"limit_violations", row.limit_violations},
            {"contact_ticks", row.contact_ticks}};
      }
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToMarkdown(const Study& study) {
  std::string text = kHead;
  for (const TargetStudy& target : study.targets) {
    text += fmt::format("## {}\n\n{}\n", target.target, Canonical(target, study.laws));
    if (!target.tasks.skipped.empty()) {
      text += fmt::format("Not run, because the arm cannot start there: {}.\n\n",
                          fmt::join(target.tasks.skipped, "; "));
    }
    const OnRandomStarts random = OnRandom(target, study.laws.front());
    if (random.runs > 0) {
      text += fmt::format("{} random starts, seed {}:\n\n{}\n", random.runs, study.seed,
                          Random(target, study.laws));
    }
  }
  text += OffendersInWords(study);
  return text + fmt::format("\nOne of the runs:\n\n```\n{}\n```\n", study.command);
}

}  // namespace fovea::laws
