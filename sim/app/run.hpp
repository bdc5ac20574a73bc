// SPDX-License-Identifier: Apache-2.0
// One simulated run, from scenario to summary and files.
#pragma once

#include <filesystem>
#include <functional>

#include "fovea/hal/clock.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/linux_rt/interrupt.hpp"
#include "sim/mcu/board_servo.hpp"
#include "sim/operator/live_page.hpp"
#include "sim/run/eye.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/verdict/summary.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

enum class Pace {
  kLockstep,  // virtual time, as fast as possible, bit-reproducible
  kReal,      // the servo on a real-time thread, 1 ms by the clock
};

// Callbacks during a run, in order of the ticks. The thread that advances the world calls `on_truth`; the
// caller's thread of RunScenario calls `on_record`. In lockstep both are one thread. Either may be empty.
struct RunObserver {
  std::function<void(const Truth&)> on_truth;
  std::function<void(const hal::TickRecord&)> on_record;
};

struct RunOptions {
  Pace pace = Pace::kLockstep;
  std::filesystem::path
      servo_image;            // the image of an emulated board that runs the servo; empty: in this process
  BoardConfig board;          // used with a servo_image
  std::filesystem::path out;  // empty: no files
  bool report = true;         // also write films, log, report and the bench's picture
  bool pictures_if_failed = false;  // the camera's pictures only if the run does not reach its goal
  int renderers = kRenderers;       // pictures that are drawn at the same time
  RendererPool* pool = nullptr;     // keeps renderers for the next run; must outlive the run; may be null
  std::string command;              // the command line, for the log; "" if none
  bool show_progress = true;
  std::filesystem::path trace;  // file for the timeline of all threads; empty: none
  RunObserver observer;
  hal::Clock* clock =
      nullptr;  // at real pace: replaces the computer's clock; the servo then waits for the pictures
  linux_rt::Interrupt* interrupt = nullptr;  // can end the run early; must outlive the run
  // In lockstep, with files: a page whose viewers watch and touch. The run then has no end of its own, and
  // its virtual time is paced to the wall clock. Must outlive the run.
  LivePage* live = nullptr;
  double live_speed = 1.0;  // at the start; see WallPace
};

// Composes robot, bench, camera and servo, runs the scenario to its end, judges it against the truth, and
// writes its files to `options.out` (see RunFiles). The files appear there only after the run. An interrupted
// run writes the same files as any run; one that ends at once keeps its log up to that time. InputError: the
// scenario cannot be run, or the files cannot be written. std::runtime_error: EGL or the renderer fails.
Summary RunScenario(const Scenario& scenario, const RunOptions& options);

}  // namespace fovea::sim
