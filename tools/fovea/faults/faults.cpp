// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "tools/fovea/atlas/atlas.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/atlas/page.hpp"
#include "tools/fovea/faults/matrix.hpp"
#include "tools/fovea/faults/page.hpp"
#include "tools/fovea/faults/text.hpp"

namespace fovea {

int FaultAtlas(const AtlasArguments& arguments) {
  const atlas::AtlasPage page(config::ShareFolder() / "report");
  matrix::MatrixOptions options;
  options.seed = arguments.seed.value_or(1);
  options.jobs = JobsOf(arguments);
  options.resume = arguments.resume;
  options.only = arguments.only;
  options.out = arguments.out.empty() ? "out/atlas-faults" : arguments.out;
  const matrix::Matrix matrix = matrix::RunMatrix(options);
  const std::string json = matrix::ToJson(matrix);
  atlas::WriteFile(options.out / "atlas.json", json);
  atlas::WriteFile(options.out / "atlas.html", page.Wrap("faults", matrix::ToHtml(matrix)));
  if (arguments.json) {
    fmt::print("{}", json);
  } else if (arguments.markdown) {
    fmt::print("{}", matrix::ToMarkdown(matrix));
  } else {
    fmt::print("{}page: {}\n", matrix::ToTable(matrix), (options.out / "atlas.html").string());
  }
  return matrix::Sum(matrix).Failed() ? config::kGoalMissed : config::kDone;
}

}  // namespace fovea
