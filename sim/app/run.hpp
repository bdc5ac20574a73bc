// One simulated run, from scenario to summary and files.
#pragma once

#include <filesystem>
#include <functional>

#include "fovea/hal/clock.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/linux_rt/interrupt.hpp"
#include "sim/mcu/board_servo.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/verdict/summary.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

enum class Pace {
  kLockstep,  // virtual time, as fast as it goes, bit-reproducible
  kReal,      // the servo on a real-time thread, 1 ms by the clock
};

// Who looks on while it runs. `on_truth` is called by the thread that advances the world, `on_record` by the
// one that called RunScenario, in order of the ticks; in lockstep that is one thread. Either may be empty.
struct RunObserver {
  std::function<void(const Truth&)> on_truth;
  std::function<void(const hal::TickRecord&)> on_record;
};

struct RunOptions {
  Pace pace = Pace::kLockstep;
  std::filesystem::path
      servo_image;            // the servo runs on an emulated board, from this file; empty: in this process
  BoardConfig board;          // with a servo_image
  std::filesystem::path out;  // empty: no files
  bool report = true;         // films, log, report and the bench's picture too
  std::string command;        // the command line, for the log; "" when there was none
  bool show_progress = true;
  std::filesystem::path trace;  // empty: none; else a file for the timeline of all threads
  RunObserver observer;
  hal::Clock* clock =
      nullptr;  // at real pace: in place of the computer's, and then the pictures are waited for
  linux_rt::Interrupt* interrupt = nullptr;  // who may end the run early; it outlives the run
};

// Composes robot, bench, camera and servo, runs the scenario to its end, judges it against the truth, and
// leaves its files in `options.out` (see RunFiles). Nothing is in place before the run is over. InputError:
// the scenario cannot be run, or the files not be written. A run that is interrupted leaves what any run
// leaves; one that is ended at once leaves its log as far as it goes. std::runtime_error: no EGL, or the
// renderer broke during the run.
Summary RunScenario(const Scenario& scenario, const RunOptions& options);

}  // namespace fovea::sim
