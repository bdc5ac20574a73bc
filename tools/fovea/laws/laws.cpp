// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "firmware/host/config/program.hpp"
#include "tools/fovea/atlas/atlas.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/laws/text.hpp"

namespace fovea {

int LawsAtlas(const AtlasArguments& arguments) {
  const laws::StudyOptions options{.seed = static_cast<std::uint64_t>(arguments.seed.value_or(1)),
                                   .random = RunsOf(arguments),
                                   .jobs = JobsOf(arguments),
                                   .resume = arguments.resume,
                                   .only = arguments.only,
                                   .assignments = arguments.assignments,
                                   .out = arguments.out.empty() ? "out/atlas-laws" : arguments.out};
  const laws::Study study = laws::RunStudy(options);
  const std::string json = laws::ToJson(study);
  atlas::WriteFile(options.out / "atlas.json", json);
  if (arguments.json) {
    fmt::print("{}", json);
  } else {
    fmt::print("{}", arguments.markdown ? laws::ToMarkdown(study) : laws::ToTable(study));
  }
  return laws::KeepsLimits(study) ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
