// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "tools/fovea/atlas/atlas.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/atlas/page.hpp"
#include "tools/fovea/contact/page.hpp"
#include "tools/fovea/contact/text.hpp"

namespace fovea {

int ContactAtlas(const AtlasArguments& arguments) {
  const atlas::AtlasPage page(config::ShareFolder() / "report");
  const contact::StudyOptions options{.seed = arguments.seed.value_or(1),
                                      .jobs = JobsOf(arguments),
                                      .resume = arguments.resume,
                                      .only = arguments.only,
                                      .out = arguments.out.empty() ? "out/atlas-contact" : arguments.out};
  const contact::Study study = contact::RunStudy(options);
  const std::string json = contact::ToJson(study);
  atlas::WriteFile(options.out / "atlas.json", json);
  atlas::WriteFile(options.out / "atlas.html", page.Wrap("contact", contact::ToHtml(study)));
  if (arguments.json) {
    fmt::print("{}", json);
  } else if (arguments.markdown) {
    fmt::print("{}", contact::ToMarkdown(study));
  } else {
    fmt::print("{}page: {}\n", contact::ToTable(study), (options.out / "atlas.html").string());
  }
  return contact::IsGood(study) ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
