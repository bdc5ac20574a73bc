// SPDX-License-Identifier: Apache-2.0
// The command `fovea-sim run`: its options, and what it does with them.
#pragma once

#include <string>
#include <vector>

#include "sim/mcu/board_servo.hpp"
#include "sim/run/eye.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fovea::sim {

// Options of --live.
struct LiveArguments {
  std::string address = "127.0.0.1";
  int port = 8765;
  bool open = false;
  std::vector<std::string> origins;
};

struct RunArguments {
  std::string scenario;
  std::vector<std::string> assignments;
  int seed = -1;
  std::string pace = "lockstep";
  std::string servo = "pc";
  std::string servo_image;
  std::string servo_pace = "lockstep";
  BoardConfig board;
  std::vector<const CLI::Option*> of_board;  // require --servo mcu
  std::vector<const CLI::Option*> of_live;   // require --live
  std::vector<const CLI::Option*> of_timer;  // require --servo-pace timer
  std::string out;
  std::string trace;
  bool no_report = false;
  std::string pictures = "always";
  int renderers = kRenderers;
  bool json = false;
  bool live = false;
  LiveArguments page;
  std::string command;  // the command line as typed
};

// The arguments must outlive the parsing of `run`.
void AddRun(CLI::App& run, RunArguments& arguments);
// Returns the program's exit code. InputError: wrong options or input. `pool`: see RunOptions.
int RunCommand(const RunArguments& arguments, RendererPool* pool = nullptr);

}  // namespace fovea::sim
