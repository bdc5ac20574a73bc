// SPDX-License-Identifier: Apache-2.0
// The runs of an atlas on disk: one line of JSON per run and per judged start, written when the run or the
// judgement ends, so that none is lost.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/judge.hpp"

namespace fovea::atlas {

// A value of a run that is not as the servo believes: one entry of a quantity of [truth].
struct Drawn {
  std::string key;  // without "truth."
  std::string unit;
  int entry = 1;  // of a list, counted from 1
  double believed = 0.0;
  double actual = 0.0;
};

// What is true of some runs beyond the settings of their atlas.
struct Case {
  std::string name;                // "": the atlas has only this one
  std::vector<std::string> truth;  // assignments of [truth], or of a law
  bool is_trial = false;           // the simulator may refuse it; no pictures are kept
};

// A run: its start, and its result in fovea-sim's summary.
struct Row {
  int index = 0;
  Start start;
  std::string case_name;
  std::vector<std::string> truth;  // of its case
  std::vector<Drawn> drawn;
  bool refused = false;  // the simulator did not run it; `verdict` is the reason
  bool converged = false;
  std::string verdict;
  std::uint64_t limit_violations = 0;
  std::uint64_t contact_ticks = 0;
  std::optional<double> settle_time_s;
  std::optional<double> final_error_px;
  std::optional<double> final_error_mm;
  std::optional<double> final_error_deg;
  std::optional<double> error_px_max;        // of the run
  std::optional<double> camera_path_m;       // length of the camera's way
  std::optional<double> camera_excursion_m;  // its largest distance from the straight line between its ends
  std::map<std::string, double> limits;      // largest used share of each limit
  std::string end_mode;                      // of the servo, at the end of the run
  std::string end_reason;                    // of Hold; "" otherwise
  std::string log_hash;

  // It ended as a run from which no way leads to the goal has to end.
  [[nodiscard]] bool HeldAsUnreachable() const {
    return end_mode == "hold" && end_reason == "goal_unreachable" && limit_violations == 0 &&
           contact_ticks == 0;
  }
};

// The settings that all rows of a folder share. Rows with another heading belong to another atlas.
struct Heading {
  std::string target;
  std::uint64_t seed = 1;
  std::vector<std::string> assignments;  // --set, in order, except those of [truth]
  std::string servo;                     // hash of the servo library
  std::vector<std::string> truth;        // assignments of [truth] from which all cases follow
  std::string starts;                    // hash of the file of --starts; "": random starts

  bool operator==(const Heading&) const = default;
};

// The row of a run, from `summary` (fovea-sim's --json). Throws when `summary` is not one, or when the target
// has another start error in the simulator than in the sampler although all is as the servo believes
// (std::runtime_error).
Row MakeRow(int index, const Start& start, const nlohmann::json& summary);

class RowFile {
 public:
  // Starts `file` again, or with `resume` continues it: rows() then contains its runs, and an incomplete last
  // line is dropped. InputError: the file cannot be written or has another heading.
  RowFile(const std::filesystem::path& file, const Heading& heading, bool resume);

  void Add(const Row& row);
  // `index`: of the judged start.
  void Add(int index, const Judgement& judgement);
  // Those of a case, by index.
  [[nodiscard]] const std::map<int, Row>& rows(const std::string& case_name = "") const;
  // Of the starts that were judged, by index.
  [[nodiscard]] const std::map<int, Judgement>& judgements() const { return judgements_; }

 private:
  void Read(const Heading& heading);
  void ReadLine(const nlohmann::json& json);
  void Write(const std::string& line);

  std::filesystem::path file_;
  std::ofstream stream_;
  std::map<std::string, std::map<int, Row>> rows_;
  std::map<int, Judgement> judgements_;
};

}  // namespace fovea::atlas
