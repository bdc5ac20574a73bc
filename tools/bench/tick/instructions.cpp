// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/instructions.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/trace/tick_trace.hpp"
#include "tools/bench/common/scratch.hpp"
#include "tools/bench/common/shell.hpp"

namespace fovea::bench {
namespace {

namespace fs = std::filesystem;

class Unwatched final : public hal::TickProbe, public hal::Recorder {
  void Enter() noexcept override {}
  void Leave() noexcept override {}
  void Record(const hal::TickRecord& /*record*/) noexcept override {}
};

double Totals(const fs::path& file) {
  std::ifstream stream(file);
  std::string word;
  while (stream >> word) {
    double count = 0.0;
    if (word == "totals:" && stream >> count) {
      return count;
    }
  }
  throw std::runtime_error(file.string() + ": callgrind wrote no totals");
}

}  // namespace

// callgrind counts in this function only. It finds the function by its name.
[[gnu::noinline]] void FoveaBenchCountedStep(task::ServoStep& step, hal::Recorder& recorder,
                                             const task::ServoInputs& inputs, task::ServoOutputs& outputs) {
  step.Step(inputs, outputs);
  recorder.Record(outputs.record);
}

void RunCounted(const std::vector<TickCase>& cases, const std::string& mode, bool traced, bool recorded) {
  std::uint64_t counted = 0;
  for (const TickCase& c : cases) {
    // The scout runs each tick first, because the mode of a tick is known only after the tick.
    task::ServoTask scout;
    task::ServoTask task;
    if (!scout.Init(c.config).ok() || !task.Init(c.config).ok()) {
      throw std::logic_error("a configuration that was run is refused");
    }
    trace::Track track("servo", traced ? trace::kSpansPerTick * c.inputs.size() : 0);
    Unwatched unwatched;
    trace::TickTrace tick_trace(track, unwatched, unwatched);
    if (traced) {
      task.UseProbe(&tick_trace);
    }
    flight::FlightRecorder flight(task, &task, 64);
    task::ServoStep& step = recorded ? static_cast<task::ServoStep&>(flight) : task;
    hal::Recorder& recorder = recorded ? static_cast<hal::Recorder&>(flight) : unwatched;
    task::ServoOutputs outputs;
    for (const task::ServoInputs& inputs : c.inputs) {
      flight.Drain([](const flight::FlightRecord&) {}, [](const flight::Keyframe&) {});
      scout.Step(inputs, outputs);
      if (hal::Name(outputs.record.mode) == mode) {
        FoveaBenchCountedStep(step, recorder, inputs, outputs);
        ++counted;
      } else {
        step.Step(inputs, outputs);
        recorder.Record(outputs.record);
      }
    }
  }
  fmt::print("{}\n", counted);
}

std::optional<double> CountInstructions(const std::vector<std::string>& arguments, const std::string& mode) {
  const Scratch scratch;
  const fs::path out = scratch.path() / "callgrind.out";
  std::string command = fmt::format(
      "valgrind --tool=callgrind --callgrind-out-file={} --collect-atstart=no "
      "--toggle-collect='*FoveaBenchCountedStep*' {}",
      Quoted(out.string()), Quoted(fs::read_symlink("/proc/self/exe").string()));
  for (const std::string& argument : arguments) {
    command += fmt::format(" {}", Quoted(argument));
  }
  command += fmt::format(" --count {} 2>/dev/null", Quoted(mode));
  const ShellResult run = RunShell(command);
  if (!run.done) {
    throw std::runtime_error("valgrind failed or is not installed (Debian package valgrind): " + command);
  }
  const double ticks = std::stod(run.output);
  if (ticks == 0.0) {
    return std::nullopt;
  }
  return Totals(out) / ticks;
}

}  // namespace fovea::bench
