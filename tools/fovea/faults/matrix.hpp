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
  double longer_s = 0.0;  // its run goes on for so long beyond what it has as a rule
  std::string command;    // that repeats it
  Outcome outcome;
};
// "<mode>.<stage>.<fault's id>.<severity>"
std::string NameOf(const Cell& cell);

struct Matrix {
  int seed = 1;
  int runs = 0;  // those without a fault among them
  std::vector<Cell> cells;
};

struct MatrixOptions {
  int seed = 1;
  int jobs = 1;
  bool resume = false;
  std::vector<std::string> only;  // parts of cells' names; empty: all
  std::filesystem::path out;      // folder for the rows
};

// How many cells there are when none is left out by --only.
std::size_t NumCells();

// Runs them. InputError: `only` leaves none, or the folder cannot be written. std::runtime_error: a run
// without a fault does not reach its goal.
Matrix RunMatrix(const MatrixOptions& options);

// What all cells come to.
struct Totals {
  int exceeded = 0;   // cells in which anything that must hold was passed
  int moved = 0;      // in which the arm moved further or faster than it may where it should stand
  int undefined = 0;  // that ended in no defined state
  int recovered = 0;
  int stopped = 0;
  int held = 0;
  int gone_on = 0;
  int touched = 0;  // in which the arm touched bench, target or itself
  int noticed = 0;
  int longer = 0;                                   // that were given more time
  const Cell* slowest = nullptr;                    // to be noticed; none when nothing was
  const Cell* last = nullptr;                       // to recover; none when none did
  std::map<std::string, const Cell*> worst_limits;  // the cell that used the most of each
  std::map<std::string, const Cell*> furthest;      // by mode: where the arm went furthest beyond a stop
  [[nodiscard]] bool Failed() const { return exceeded > 0 || moved > 0 || undefined > 0; }
};
Totals Sum(const Matrix& matrix);

}  // namespace fovea::matrix
