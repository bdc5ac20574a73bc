// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/cyclictest.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/bench/common/scratch.hpp"
#include "tools/bench/common/shell.hpp"

namespace fovea::bench {

bool HasCyclictest() { return RunShell("command -v cyclictest 2>/dev/null").done; }

std::optional<std::vector<double>> RunCyclictest(int periods, const std::string& policy, int cpu) {
  const Scratch scratch;
  const std::string file = (scratch.path() / "cyclictest.json").string();
  constexpr int kMostUs = 1'000'000;
  const std::string command = fmt::format(
      "cyclictest -q -m -t1 -i1000 -l{} -h{} {} {} --json={} >/dev/null 2>&1", periods, kMostUs,
      policy == "fifo" ? "-p80" : "--policy=other", cpu < 0 ? "" : fmt::format("-a{}", cpu), Quoted(file));
  const bool done = RunShell(command).done;
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return done ? ReadCyclictest(text.str()) : std::nullopt;
}

std::optional<std::vector<double>> ReadCyclictest(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const nlohmann::json::json_pointer place("/thread/0/histogram");
  if (!json.is_object() || !json.contains(place) || !json[place].is_object()) {
    return std::nullopt;
  }
  std::vector<double> us;
  for (const auto& [latency, count] : json[place].items()) {
    if (!count.is_number_unsigned() || latency.find_first_not_of("0123456789") != std::string::npos) {
      return std::nullopt;
    }
    us.insert(us.end(), count.get<std::size_t>(), std::stod(latency) + 0.5);
  }
  return us.empty() ? std::nullopt : std::make_optional(us);
}

}  // namespace fovea::bench
