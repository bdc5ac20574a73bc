// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/mcu/mcu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "tools/bench/common/figure.hpp"
#include "tools/bench/common/scratch.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/bench/mcu/link_map.hpp"

namespace fovea::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// Cycles per instruction. Arm publishes no figure for this processor. 0.5: it issues at most two instructions
// per cycle. 1 and 3 are assumptions, 3 for code that mostly waits for doubles. No board was measured.
constexpr std::array<double, 3> kCyclesPerInstruction{0.5, 1.0, 3.0};
constexpr double kInHand = 2.0;
constexpr double kTicksPerSecond = 1000.0;

// Collects the figures for --json, and their lines of text.
class Sheet {
 public:
  void Title(const std::string& text) { text_ += fmt::format("{}\n", text); }
  void Add(const std::string& name, double value, const std::string& unit, const std::string& label) {
    figures_.push_back({"mcu_" + name, value, unit, {}});
    text_ += fmt::format("  {:<28}{:>12.5g} {}\n", label, value, unit);
  }
  void AddSpread(const std::string& name, const ordered_json& spread, const std::string& label) {
    text_ += fmt::format("  {:<28}", label);
    for (const char* which : {"min", "p50", "max"}) {
      const double value = spread[which];
      figures_.push_back({fmt::format("mcu_{}_{}", name, which), value, "instructions", {}});
      text_ += fmt::format("{:>12.0f}", value);
    }
    text_ += '\n';
  }
  void AddModule(const std::string& module, const ModuleBytes& bytes) {
    std::string name = module;
    std::replace(name.begin(), name.end(), ' ', '_');
    for (const auto& [memory, size] : {std::pair{"flash", bytes.flash}, {"ram", bytes.ram}}) {
      if (size > 0) {
        figures_.push_back({fmt::format("mcu_{}_{}", memory, name), static_cast<double>(size), "bytes", {}});
      }
    }
    text_ += fmt::format("  {:<28}{:>12}{:>12}\n", module, bytes.flash, bytes.ram);
  }
  [[nodiscard]] const std::vector<Figure>& figures() const { return figures_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::vector<Figure> figures_;
  std::string text_;
};

// The board's entry in the summary of `fovea-sim run SCENARIO --servo mcu`.
ordered_json BoardOf(const fs::path& program, const std::string& scenario, double seconds) {
  const Scratch scratch;
  const fs::path words = scratch.path() / "words";
  const std::string command =
      fmt::format("{} run {} --servo mcu --no-report --json --set run.duration_s={} --out {} 2>{}",
                  Quoted(program.string()), scenario, seconds, Quoted((scratch.path() / "out").string()),
                  Quoted(words.string()));
  // A run that is too short to converge has not failed. Its output counts, not its exit code.
  const ordered_json summary =
      ordered_json::parse(RunShell(command).output, nullptr, /*allow_exceptions=*/false);
  if (!summary.is_object() || !summary.contains("mcu")) {
    const std::string said = RunShell("tail -n 1 " + Quoted(words.string())).output;
    throw std::runtime_error(fmt::format("{} did not run on the board: {}", scenario, said));
  }
  return summary["mcu"];
}

}  // namespace

int RunMcu(const McuArguments& arguments) {
  const fs::path program = SimulatorBeside("fovea-bench mcu");
  const LinkMap map = ReadLinkMap(config::ShareFolder() / "fovea-mcu.map");
  Sheet sheet;
  double most = 0.0;
  double stack = 0.0;
  for (const auto& [scenario, seconds] :
       {std::pair<std::string, double>{"ball", arguments.seconds}, {"square", 0.25 * arguments.seconds}}) {
    const ordered_json board = BoardOf(program, scenario, seconds);
    sheet.Title(fmt::format("{}, {} ticks: instructions, least, median, most; resolution {:g}", scenario,
                            board["instructions"]["ticks"].get<int>(),
                            std::max(1.0, board["instructions_per_count"].get<double>())));
    sheet.AddSpread(scenario + "_tick", board["instructions"]["tick"], "tick");
    for (const auto& [mode, ticks] : board["instructions_by_mode"].items()) {
      sheet.AddSpread(fmt::format("{}_{}", scenario, mode), ticks["tick"], "  in " + mode);
    }
    for (const auto& [stage, spread] : board["instructions"]["stages"].items()) {
      sheet.AddSpread(fmt::format("{}_stage_{}", scenario, stage), spread, "  stage " + stage);
    }
    sheet.AddSpread(scenario + "_link", board["link_instructions"], "serial line, outside the tick");
    const double all =
        board["instructions"]["tick"]["max"].get<double>() + board["link_instructions"]["max"].get<double>();
    most = std::max(most, all);
    stack = std::max(stack, board["stack_bytes"].get<double>());
    for (const double cycles : kCyclesPerInstruction) {
      sheet.Add(fmt::format("{}_clock_mhz_at_{:g}_cycles", scenario, cycles),
                1e-6 * kInHand * kTicksPerSecond * cycles * all, "MHz",
                fmt::format("clock at {:g} cycles each", cycles));
    }
  }
  sheet.Title("(clock for 1 kHz with a reserve of factor 2, from the most of tick and serial line together)");
  sheet.Title("stack");
  sheet.Add("stack_bytes", stack, "bytes", "deepest use");
  sheet.Title("image                                flash         RAM   bytes");
  for (const auto& [module, bytes] : map.modules) {
    sheet.AddModule(module, bytes);
  }
  sheet.AddModule("total", map.total);
  fmt::print("{}", arguments.json ? ToJson(sheet.figures()) + "\n" : sheet.text());
  return config::kDone;
}

}  // namespace fovea::bench
