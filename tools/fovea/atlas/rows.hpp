// SPDX-License-Identifier: Apache-2.0
// The runs of an atlas on disk: one line of JSON per run, written when the run ends, so that none is lost.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/sampler.hpp"

namespace fovea::atlas {

// A run: its start, and its result in fovea-sim's summary.
struct Row {
  int index = 0;
  Start start;
  bool converged = false;
  std::string verdict;
  std::uint64_t limit_violations = 0;
  std::uint64_t contact_ticks = 0;
  std::optional<double> settle_time_s;
  std::optional<double> final_error_px;
  std::optional<double> final_error_mm;
  std::optional<double> final_error_deg;
  std::map<std::string, double> limits;  // largest used share of each limit
  std::string log_hash;
};

// The settings that all rows of a folder share. Rows with another heading belong to another atlas.
struct Heading {
  std::string target;
  std::uint64_t seed = 1;
  std::vector<std::string> assignments;  // --set, in order
  std::string servo;                     // hash of the servo library

  bool operator==(const Heading&) const = default;
};

// The row of a run, from `summary` (fovea-sim's --json). Throws when `summary` is not one, or when the target
// has another start error in the simulator than in the sampler (std::runtime_error).
Row MakeRow(int index, const Start& start, const nlohmann::json& summary);

class RowFile {
 public:
  // Starts `file` again, or with `resume` continues it: rows() then contains its runs, and an incomplete last
  // line is dropped. InputError: the file cannot be written or has another heading.
  RowFile(const std::filesystem::path& file, const Heading& heading, bool resume);

  void Add(const Row& row);
  // By index.
  [[nodiscard]] const std::map<int, Row>& rows() const { return rows_; }

 private:
  void Read(const Heading& heading);
  void Write(const std::string& line);

  std::filesystem::path file_;
  std::ofstream stream_;
  std::map<int, Row> rows_;
};

}  // namespace fovea::atlas
