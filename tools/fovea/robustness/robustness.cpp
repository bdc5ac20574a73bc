// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/robustness.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/atlas/page.hpp"
#include "tools/fovea/robustness/page.hpp"
#include "tools/fovea/robustness/study.hpp"
#include "tools/fovea/robustness/text.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;
using robustness::Spec;

// What is written and printed.
struct Results {
  std::string json;
  std::string csv;
  std::string html;
  std::string table;
  bool is_good = false;
};

void Keep(const fs::path& folder, const std::string& title, const Results& results,
          const atlas::AtlasPage& page) {
  atlas::WriteFile(folder / "atlas.json", results.json);
  atlas::WriteFile(folder / "atlas.csv", results.csv);
  atlas::WriteFile(folder / "atlas.html", page.Wrap(title, results.html));
}

std::vector<std::string> TargetsOf(const AtlasArguments& arguments) {
  if (!arguments.robustness) {
    return {arguments.target};
  }
  std::vector<std::string> targets;
  for (const char* name : features::kTargetNames) {
    if (arguments.only.empty() ||
        std::find(arguments.only.begin(), arguments.only.end(), name) != arguments.only.end()) {
      targets.emplace_back(name);
    }
  }
  for (const std::string& only : arguments.only) {
    if (std::find(targets.begin(), targets.end(), only) == targets.end()) {
      throw config::InputError(fmt::format("--only {}: no such target; allowed are {}", only,
                                           fmt::join(features::kTargetNames, ", ")));
    }
  }
  return targets;
}

Results SizeResults(const AtlasArguments& arguments, const Spec& spec, const fs::path& folder) {
  atlas::Batch batch(HeadingOf(arguments, arguments.target, robustness::Scaled(spec, 1.0)), folder,
                     JobsOf(arguments), arguments.resume);
  std::vector<double> each = arguments.sizes;
  std::sort(each.begin(), each.end());
  each.erase(std::unique(each.begin(), each.end()), each.end());
  const auto sizes = robustness::RunSizes(batch, spec, each, RunsOf(arguments));
  return {ToJson(spec, sizes), ToCsv(sizes), ToHtml(spec, sizes),
          ToTable(sizes, config::StyleOf(STDOUT_FILENO)),
          std::all_of(sizes.begin(), sizes.end(),
                      [](const auto& one) { return one.size > 1.0 || one.figures.ReachedGoal(); })};
}

Results TornadoResults(const AtlasArguments& arguments, const Spec& spec, const fs::path& folder) {
  std::vector<robustness::Tornado> tornados;
  for (const std::string& target : TargetsOf(arguments)) {
    atlas::Batch batch(HeadingOf(arguments, target, robustness::Scaled(spec, 1.0)),
                       arguments.robustness ? folder / target : folder, JobsOf(arguments), arguments.resume);
    tornados.push_back(robustness::RunTornado(batch, spec, RunsOf(arguments), arguments.alone,
                                              arguments.margin || arguments.robustness));
  }
  Results results{ToJson(spec, tornados), ToCsv(tornados), ToHtml(spec, tornados), "",
                  std::all_of(tornados.begin(), tornados.end(), robustness::KeepsLimits)};
  if (arguments.markdown) {
    results.table = ToMarkdown(spec, tornados);
    return results;
  }
  for (const robustness::Tornado& tornado : tornados) {
    results.table += ToTable(tornado, config::StyleOf(STDOUT_FILENO));
  }
  return results;
}

}  // namespace

int RobustnessAtlas(const AtlasArguments& arguments) {
  const atlas::AtlasPage page(config::ShareFolder() / "report");
  const Spec spec = TruthOf(arguments);
  const std::string title = arguments.robustness ? "robustness" : arguments.target;
  const fs::path folder =
      arguments.out.empty() ? fs::path("out") / ("atlas-" + title) : fs::path(arguments.out);
  const Results results = arguments.sizes.empty() ? TornadoResults(arguments, spec, folder)
                                                  : SizeResults(arguments, spec, folder);
  Keep(folder, title, results, page);
  if (arguments.json) {
    fmt::print("{}", results.json);
  } else if (arguments.markdown) {
    fmt::print("{}", results.table);
  } else {
    config::PrintedTable where(config::StyleOf(STDOUT_FILENO));
    where.WholeRow("page", (folder / "atlas.html").string());
    fmt::print("{}{}", results.table, where.text());
  }
  return results.is_good ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
