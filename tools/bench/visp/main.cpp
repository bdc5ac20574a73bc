// SPDX-License-Identifier: Apache-2.0
// fovea-bench-visp: times the visual law and ViSP's. A separate program that is not installed: ViSP is under
// the GPL, and no package of this project may need it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "firmware/host/config/program.hpp"
#include "tools/bench/visp/speed.hpp"

int main(int argc, char** argv) {
  using namespace fovea;
  CLI::App app{
      "Times the visual law and ViSP's in one run: from four points to the camera's twist, with s, L_s and "
      "the error."};
  bool json = false;
  app.add_flag("--json", json, "Print JSON");
  app.footer("Example:\n  fovea-bench-visp\nExit: 0 done, 2 wrong usage, or the two twists differ.");
  return config::RunProgram("fovea-bench-visp", app, argc, argv, [&] {
    const std::vector<bench::Figure> figures = bench::VispSpeed();
    fmt::print("{}", json ? bench::ToJson(figures) + "\n" : bench::ToTable(figures));
    return config::kDone;
  });
}
