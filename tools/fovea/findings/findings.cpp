// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "firmware/host/config/program.hpp"
#include "tools/fovea/atlas/atlas.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/findings/text.hpp"

namespace fovea {

int FindingsAtlas(const AtlasArguments& arguments) {
  const findings::StudyOptions options{.seed = arguments.seed.value_or(1),
                                       .runs = RunsOf(arguments),
                                       .jobs = JobsOf(arguments),
                                       .resume = arguments.resume,
                                       .out = arguments.out.empty() ? "out/atlas-findings" : arguments.out};
  const findings::Study study = findings::RunStudy(options);
  const std::string json = findings::ToJson(study);
  atlas::WriteFile(options.out / "atlas.json", json);
  if (arguments.json) {
    fmt::print("{}", json);
  } else {
    fmt::print("{}", arguments.markdown ? findings::ToMarkdown(study) : findings::ToTable(study));
  }
  return findings::IsGood(study) ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
