// SPDX-License-Identifier: Apache-2.0
// fovea-adversary: hours of robot time with adversarial measurements. Exit 1 if a limit was exceeded, the arm
// touched something, or a measurement led to a fault.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "firmware/host/config/program.hpp"
#include "tests/closed_loop/adversary_run.hpp"

int main(int argc, char** argv) {
  using namespace fovea;
  CLI::App app{"Fovea under measurements that freeze, repeat, mirror, jump and run away."};
  double hours = 0.1;
  std::uint64_t seed = 1;
  app.add_option("--hours", hours, "hours of robot time")->check(CLI::Range(1e-4, 1000.0));
  app.add_option("--seed", seed, "seed of the attacks");
  app.footer("Example:\n  fovea-adversary --hours 10 --seed 7");
  return config::RunProgram("fovea-adversary", app, argc, argv, [&] {
    double next = 0.05;
    const test::AdversaryFigures figures = test::RunAdversary(3600.0 * hours, seed, [&](double share) {
      if (share >= next) {
        fmt::print(stderr, "{:.0f} %\n", 100.0 * share);
        next += 0.05;
      }
    });
    fmt::print("{}", test::InWords(figures));
    return figures.Sound() ? config::kDone : config::kGoalMissed;
  });
}
