// The runs of an atlas on disk: one line of JSON each, written as it comes, so that what was done is kept.
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

// A run: where it began, and what fovea-sim said of it.
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
  std::map<std::string, double> limits;  // largest used share of each
  std::string log_hash;
};

// What a folder's rows have in common. Rows of another atlas are none of this one's.
struct Heading {
  std::string target;
  std::uint64_t seed = 1;
  std::vector<std::string> assignments;  // --set, in order
  std::string servo;                     // hash of the servo library

  bool operator==(const Heading&) const = default;
};

// The row of a run that `summary` (fovea-sim's --json) tells of. std::runtime_error when it is none, or when
// the simulator saw the target elsewhere than the sampler put it.
Row MakeRow(int index, const Start& start, const nlohmann::json& summary);

class RowFile {
 public:
  // Begins `file` anew, or with `resume` goes on with what is there: rows() then holds its runs, and a last
  // line that was cut off is dropped. InputError: it cannot be written, or is not of `heading`.
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
