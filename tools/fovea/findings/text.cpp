// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/findings/text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/terminal.hpp"

namespace fovea::findings {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kHead = R"(# What runs find out

Printed by `fovea atlas --findings --markdown`. In each run of the scenario `ball-exciting`, latency, mount, focal length and
load are not what the servo believes: they are drawn with the run's seed. So are errors that the run does not look for, as
every arm has them: the zeros of the encoders (1 mrad), the masses of the links (1 %) and the torques (0.2 % of the largest).
The ball lies elsewhere in each run, by up to 3 cm to each side and 4 cm in height. From its own records the run estimates
each quantity below, with a standard deviation ([how](../tools/fovea/README.md#from-a-log)). This page compares these
estimates with what was drawn. The exit code is 0 when each quantity is known in at least 95 % of the runs, the true value is
within two stated standard deviations in 90 to 99 % of these, and no stated standard deviation is above the limit in the
table.

)";

std::string Known(const Coverage& c) { return fmt::format("{} of {}", c.known, c.runs); }

std::string Within(const Coverage& c) { return fmt::format("{:.1f} %", 100.0 * c.WithinShare()); }

}  // namespace

std::string Verdict(const Study& study) {
  if (study.unfinished > 0) {
    return fmt::format("{} of {} runs broke off", study.unfinished, study.runs);
  }
  for (std::size_t i = 0; i < study.coverages.size(); ++i) {
    const Coverage& c = study.coverages[i];
    if (!Meets(c, ComparedBeliefs()[i].goal)) {
      return fmt::format("{}: known in {}, within two standard deviations in {}, sigma up to {:.3g} {}",
                         ComparedBeliefs()[i].belief, Known(c), Within(c), c.sigma_largest,
                         ComparedBeliefs()[i].unit);
    }
  }
  return fmt::format("in {} runs, what was found out is true and as sure as stated", study.runs);
}

std::string ToTable(const Study& study) {
  config::PrintedTable table(config::StyleOf(STDOUT_FILENO));
  table.Row("verdict", Verdict(study), IsGood(study) ? config::Paint::kGood : config::Paint::kBad);
  for (std::size_t i = 0; i < study.coverages.size(); ++i) {
    const Coverage& c = study.coverages[i];
    table.WholeRow(ComparedBeliefs()[i].belief,
                   fmt::format("known in {}, {} within two sigma; error {:.3g} {} rms; sigma {:.3g}, at most "
                               "{:.3g}",
                               Known(c), Within(c), c.error_rms, ComparedBeliefs()[i].unit, c.sigma_median,
                               c.sigma_largest));
  }
  return table.text();
}

std::string ToJson(const Study& study) {
  Json json{{"seed", study.seed},    {"runs", study.runs},        {"unfinished", study.unfinished},
            {"good", IsGood(study)}, {"verdict", Verdict(study)}, {"beliefs", Json::object()}};
  for (std::size_t i = 0; i < study.coverages.size(); ++i) {
    const Coverage& c = study.coverages[i];
    json["beliefs"][ComparedBeliefs()[i].belief] = {
        {"unit", ComparedBeliefs()[i].unit},      {"known", c.known},
        {"within_two_sigma", c.within_two_sigma}, {"error_rms", c.error_rms},
        {"error_largest", c.error_largest},       {"sigma_median", c.sigma_median},
        {"sigma_largest", c.sigma_largest},       {"sigma_most", ComparedBeliefs()[i].goal.sigma_most}};
  }
  return json.dump(2) + "\n";
}

std::string ToMarkdown(const Study& study) {
  std::string text = kHead;
  text += fmt::format("{} runs, seeds {} to {}: {}.\n\n", study.runs, study.seed, study.seed + study.runs - 1,
                      Verdict(study));
  text +=
      "| quantity | known in | true value within two stated standard deviations | error: rms, largest | "
      "stated "
      "standard deviation: median, largest | limit of it |\n|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < study.coverages.size(); ++i) {
    const Coverage& c = study.coverages[i];
    text += fmt::format("| {} | {} | {} | {:.3g}, {:.3g} {} | {:.3g}, {:.3g} | {:g} |\n",
                        ComparedBeliefs()[i].belief, Known(c), Within(c), c.error_rms, c.error_largest,
                        ComparedBeliefs()[i].unit, c.sigma_median, c.sigma_largest,
                        ComparedBeliefs()[i].goal.sigma_most);
  }
  return text + fmt::format("\nOne of the runs:\n\n```\n{}\n```\n", study.command);
}

}  // namespace fovea::findings
