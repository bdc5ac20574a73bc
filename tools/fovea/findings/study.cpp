// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/findings/study.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>
#include <string_view>

#include "tools/fovea/atlas/goal_postures.hpp"
#include "tools/fovea/faults/runs.hpp"

namespace fovea::findings {
namespace {

using matrix::Job;
using nlohmann::json;

constexpr const char* kScenario = "ball-exciting";

const json& Member(const json& object, const char* name, const Job& job) {
  const auto found = object.find(name);
  if (found == object.end()) {
    throw std::runtime_error(fmt::format("{}: the summary has no '{}'", job.name, name));
  }
  return *found;
}

// One array per compared belief: known, difference, sigma, truth.
json RowOf(const Job& job, const json& summary) {
  json row = json::array();
  for (const Compared& compared : ComparedBeliefs()) {
    const json& belief = Member(Member(Member(summary, "beliefs", job), "values", job), compared.belief, job);
    const json& truth = Member(Member(summary, "truth", job), compared.truth, job);
    const double believed = truth.at("believed").at(static_cast<std::size_t>(compared.entry));
    const double actual = truth.at("true").at(static_cast<std::size_t>(compared.entry));
    const bool known = belief.at("known");
    row.push_back(
        {known, known ? belief.at("difference") : json(0.0), known ? belief.at("sigma") : json(0.0),
         std::string_view(compared.unit) == "%" ? 100.0 * (actual / believed - 1.0) : actual - believed});
  }
  return row;
}

Finding FindingOf(const json& row, std::size_t belief) {
  if (row.is_null()) {
    return {};
  }
  const json& values = row.at(belief);
  return {values.at(0), values.at(1), values.at(2), values.at(3)};
}

// A detector's errors repeat from run to run while the views do: the ball lies elsewhere in each run.
std::string PlaceOf(int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  const double x = atlas::Uniform(random, 0.44, 0.50);
  const double y = atlas::Uniform(random, -0.065, -0.005);
  const double z = atlas::Uniform(random, 0.04, 0.08);
  return fmt::format("target.position=[{:.4f}, {:.4f}, {:.4f}]", x, y, z);
}

std::vector<Job> JobsOf(const StudyOptions& options) {
  std::vector<Job> jobs;
  for (int i = 0; i < options.runs; ++i) {
    const int seed = options.seed + i;
    jobs.push_back({fmt::format("seed{}", seed), kScenario, {PlaceOf(seed)}, seed});
  }
  return jobs;
}

}  // namespace

const std::vector<Compared>& ComparedBeliefs() {
  static const std::vector<Compared> compared{
      {"latency", "camera.latency_ms", 0, "ms", {2.0}},
      {"mount turn about the camera's x axis", "camera.mount_turn_deg", 0, "deg", {0.3}},
      {"mount turn about the camera's y axis", "camera.mount_turn_deg", 1, "deg", {0.3}},
      {"mount turn about the camera's z axis", "camera.mount_turn_deg", 2, "deg", {0.3}},
      {"focal length", "camera.f_px", 0, "%", {0.5}},
      {"load", "arm.load_mass", 0, "kg", {0.05}}};
  return compared;
}

Study RunStudy(const StudyOptions& options) {
  const std::vector<Job> jobs = JobsOf(options);
  matrix::Runs runs(options.out, options.seed, options.jobs, options.resume,
                    {.program = "fovea atlas --findings",
                     .excerpt = [](const Job& job, const json& summary, const std::filesystem::path&) {
                       return RowOf(job, summary);
                     }});
  {
    atlas::Progress progress("findings", options.runs);
    runs.Execute(jobs, progress);
  }
  Study study{options.seed, options.runs, 0, {}, matrix::CommandOf(jobs.front(), options.seed)};
  for (const Job& job : jobs) {
    study.unfinished += runs.SummaryOf(job.name).is_null() ? 1 : 0;
  }
  for (std::size_t belief = 0; belief < ComparedBeliefs().size(); ++belief) {
    std::vector<Finding> findings;
    findings.reserve(jobs.size());
    for (const Job& job : jobs) {
      findings.push_back(FindingOf(runs.SummaryOf(job.name), belief));
    }
    study.coverages.push_back(CoverageOf(findings));
  }
  return study;
}

bool IsGood(const Study& study) {
  bool good = study.unfinished == 0;
  for (std::size_t i = 0; i < study.coverages.size(); ++i) {
    good = good && Meets(study.coverages[i], ComparedBeliefs()[i].goal);
  }
  return good;
}

}  // namespace fovea::findings
