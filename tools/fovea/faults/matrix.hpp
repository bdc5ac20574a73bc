// SPDX-License-Identifier: Apache-2.0
// fovea atlas --faults: every fault at every severity, in every mode of run and at every stage of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/fovea/faults/judge.hpp"
#include "tools/fovea/faults/stages.hpp"
#include "tools/fovea/faults/table.hpp"

namespace fovea::matrix {

struct Cell {
  const RunMode* mode = nullptr;
  Stage stage = Stage::kBoot;
  const Fault* fault = nullptr;
  std::size_t severity = 0;  // of kSeverities
  double onset_s = 0.0;
  double longer_s = 0.0;  // extra time that its run got
  std::string command;    // repeats its run
  Outcome outcome;
};
// "<mode>.<stage>.<fault's id>.<severity>"
std::string NameOf(const Cell& cell);

struct Matrix {
  int seed = 1;
  int runs = 0;  // includes the runs without a fault
  std::vector<Cell> cells;
};

struct MatrixOptions {
  int seed = 1;
  int jobs = 1;
  bool resume = false;
  std::vector<std::string> only;  // parts of the names of cells; empty: all cells
  std::filesystem::path out;      // folder for the rows
};

// The number of cells without --only.
std::size_t NumCells();

// Runs the selected cells. InputError: `only` selects none, or the folder cannot be written.
// std::runtime_error: a run without a fault does not reach its goal.
Matrix RunMatrix(const MatrixOptions& options);

// Totals over all cells.
struct Totals {
  int exceeded = 0;   // cells in which a limit was exceeded
  int moved = 0;      // cells in which the arm moved too far or too fast while it had to stand
  int undefined = 0;  // cells that ended in no defined state
  int recovered = 0;
  int stopped = 0;
  int held = 0;
  int gone_on = 0;
  int touched = 0;  // cells in which the arm touched bench, target or itself
  int noticed = 0;
  int longer = 0;                                   // cells whose run got extra time
  const Cell* slowest = nullptr;                    // noticed last; null: none was noticed
  const Cell* last = nullptr;                       // recovered last; null: none recovered
  std::map<std::string, const Cell*> worst_limits;  // by limit: the cell that used the most of it
  std::map<std::string, const Cell*> furthest;      // by mode: the cell that went furthest beyond a stop
  [[nodiscard]] bool Failed() const { return exceeded > 0 || moved > 0 || undefined > 0; }
};
Totals Sum(const Matrix& matrix);

}  // namespace fovea::matrix
