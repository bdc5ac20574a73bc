// SPDX-License-Identifier: Apache-2.0
// Command-line flags for the calibration board, the same in every program.
#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/host/calibration/board.hpp"
#include "firmware/host/config/input_error.hpp"

namespace fovea::config {

struct BoardFlags {
  std::string size = "9x6";
  calibration::Board board;
};

inline void AddBoardFlags(CLI::App& command, BoardFlags& flags) {
  command.add_option("--board", flags.size, "inner corners, columns x rows; one less than squares")
      ->capture_default_str();
  command.add_option("--square", flags.board.square, "side of a square [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      .add_option("--marker", flags.board.marker, "side of a ChArUco board's markers [m]; 0: a chessboard")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--dictionary", flags.board.dictionary, "dictionary of the markers")
      ->check(CLI::IsMember(std::vector<std::string>(calibration::kDictionaryNames.begin(),
                                                     calibration::kDictionaryNames.end())))
      ->capture_default_str();
}

// InputError when no such board is possible.
inline calibration::Board MakeBoard(const BoardFlags& flags) {
  calibration::Board board = flags.board;
  char cross = 0;
  std::istringstream size(flags.size);
  if (!(size >> board.columns >> cross >> board.rows) || cross != 'x' || !size.eof() || board.columns < 3 ||
      board.rows < 3 || board.columns > 100 || board.rows > 100) {
    throw InputError("--board " + flags.size +
                     ": must be columns x rows of inner corners, each 3 to 100, as in 9x6");
  }
  try {
    calibration::CheckBoard(board);
  } catch (const calibration::CalibrationError& error) {
    throw InputError(std::string("--board, --marker, --dictionary: ") + error.what());
  }
  return board;
}

}  // namespace fovea::config
