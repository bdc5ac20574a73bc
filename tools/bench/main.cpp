// SPDX-License-Identifier: Apache-2.0
// fovea-bench: benchmarks. Each command prints a table, or with --json a list of {name, value, unit, goal}.
#include <CLI/CLI.hpp>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/host/build_info.hpp"
#include "firmware/host/config/program.hpp"
#include "tools/bench/compare/compare.hpp"
#include "tools/bench/jitter/jitter.hpp"
#include "tools/bench/jitter/load.hpp"
#include "tools/bench/mcu/mcu.hpp"
#include "tools/bench/sim/sim.hpp"
#include "tools/bench/tick/tick.hpp"
#include "tools/bench/vision/vision.hpp"
#include "tools/bench/wire/wire.hpp"

int main(int argc, char** argv) {
  using namespace fovea;
  CLI::App app{"Fovea's benchmarks. Each prints its figures, and their goals if there are any."};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("fovea-bench ") + kVersion + " " + kGitRevision);
  app.footer(
      "Examples:\n  fovea-bench tick\n  fovea-bench tick --instructions --json\n  fovea-bench jitter "
      "--seconds 60 --load cpu\n  fovea-bench vision --target sphere --class noise-15\n  fovea-bench compare "
      "old.json new.json --most 1.05\nExit: 0 done, 1 compare "
      "found more than --most, 2 wrong usage "
      "or input.");

  bench::TickArguments tick;
  CLI::App* tick_command = app.add_subcommand(
      "tick", "measure the time of one servo tick by input, stage and mode, and compare with KDL");
  tick_command->add_option("--robot", tick.robot, "A shipped arm, or the path of an arm file or URDF")
      ->capture_default_str();
  tick_command
      ->add_option("--runs", tick.runs,
                   "Number of random closed loops that are searched for the slowest tick")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  tick_command->add_flag("--instructions", tick.instructions,
                         "Also count instructions, with valgrind (takes minutes)");
  tick_command->add_option("--count", tick.count)->group("");  // hidden: for the process under valgrind
  tick_command->add_flag("--traced", tick.traced)->group("");
  tick_command->add_flag("--recorded", tick.recorded)->group("");
  tick_command->add_flag("--json", tick.json, "Print JSON");

  bench::JitterArguments jitter;
  CLI::App* jitter_command = app.add_subcommand("jitter",
                                                "measure whether this machine keeps 1 kHz: the servo loop, a "
                                                "thread that only sleeps, and cyclictest if installed");
  jitter_command
      ->add_option("--seconds", jitter.seconds,
                   "Measuring time of each kind [s]; the kinds alternate in blocks of 1 s")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  jitter_command->add_option("--load", jitter.load, "Load on the machine during the measurement")
      ->check(CLI::IsMember(bench::kLoads))
      ->capture_default_str();
  jitter_command
      ->add_option("--policy", jitter.policy, "Scheduling of the measured thread: SCHED_FIFO, or the default")
      ->check(CLI::IsMember({"fifo", "other"}))
      ->capture_default_str();
  jitter_command->add_option("--cpu", jitter.cpu, "Processor that the measured thread is bound to")
      ->check(CLI::NonNegativeNumber);
  jitter_command->add_option("--out", jitter.out, "Folder for jitter.html and jitter.json")
      ->capture_default_str();
  jitter_command->add_option("--trace", jitter.trace,
                             "File to write a timeline to, for ui.perfetto.dev or chrome://tracing");
  jitter_command->add_flag("--json", jitter.json, "Print JSON");

  bench::SimArguments sim;
  CLI::App* sim_command = app.add_subcommand(
      "sim", "measure the simulator's speed by image size and rate, and where its time goes");
  sim_command->add_option("--seconds", sim.seconds, "Simulated time of each run [s]")
      ->check(CLI::Range(0.5, 1000.0))
      ->capture_default_str();
  sim_command->add_flag("--shares", sim.shares, "Measure only the time by activity, joints and image size");
  sim_command->add_flag("--json", sim.json, "Print JSON");

  bench::McuArguments mcu;
  CLI::App* mcu_command = app.add_subcommand("mcu",
                                             "count the servo's instructions on a Cortex-M7 in QEMU by stage "
                                             "and mode, and its stack, flash and RAM");
  mcu_command->add_option("--seconds", mcu.seconds, "Simulated time of ball [s]; square gets a quarter of it")
      ->check(CLI::Range(0.4, 1000.0))
      ->capture_default_str();
  mcu_command->add_flag("--json", mcu.json, "Print JSON");

  bench::WireArguments wire;
  CLI::App* wire_command = app.add_subcommand(
      "wire", "measure the robot's network interface at real pace: states per second, jitter, response time");
  wire_command->add_option("--seconds", wire.seconds, "Measuring time [s]; in lockstep the robot's time")
      ->check(CLI::Range(0.5, 100000.0))
      ->capture_default_str();
  wire_command
      ->add_option("--pace", wire.pace,
                   "real: the robot runs in real time; lockstep: it waits for each answer, so the counts are "
                   "the same on any machine")
      ->check(CLI::IsMember({"real", "lockstep"}))
      ->capture_default_str();
  wire_command->add_flag("--json", wire.json, "Print JSON");

  bench::VisionArguments vision;
  std::vector<std::string> targets(features::kTargetNames.begin(), features::kTargetNames.end());
  targets.emplace_back("all");
  CLI::App* vision_command =
      app.add_subcommand("vision", "measure detection rate, accuracy and time on images with ground truth");
  vision_command->add_option("--target", vision.target, "Target to detect")
      ->check(CLI::IsMember(targets))
      ->capture_default_str();
  vision_command->add_option("--class", vision.only, "One class of pictures; default: all");
  vision_command
      ->add_option("--pictures", vision.pictures, "Pictures of each class; a third of them without a target")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  vision_command->add_option("--seed", vision.seed, "Seed of the pictures")->capture_default_str();
  vision_command->add_flag("--json", vision.json, "Print JSON");

  bench::CompareArguments compare;
  CLI::App* compare_command = app.add_subcommand("compare", "print the ratios of two --json files");
  compare_command->add_option("old", compare.old_file)->required();
  compare_command->add_option("new", compare.new_file)->required();
  compare_command
      ->add_option("--most", compare.most,
                   "Fail when a new figure exceeds this multiple of the old one, or is missing")
      ->check(CLI::PositiveNumber);

  return config::RunProgram("fovea-bench", app, argc, argv, [&] {
    return compare_command->parsed()  ? bench::RunCompare(compare)
           : jitter_command->parsed() ? bench::RunJitter(jitter)
           : mcu_command->parsed()    ? bench::RunMcu(mcu)
           : sim_command->parsed()    ? bench::RunSim(sim)
           : vision_command->parsed() ? bench::RunVision(vision)
           : wire_command->parsed()   ? bench::RunWire(wire)
                                      : bench::RunTick(tick);
  });
}
