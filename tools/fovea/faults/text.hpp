// SPDX-License-Identifier: Apache-2.0
// A fault matrix as text: one line per cell, a Markdown page, and JSON.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/fovea/faults/matrix.hpp"

namespace fovea::matrix {

// The cells of one fault at one severity in one mode, by stage; null where a cell makes no sense or is not
// selected.
struct MatrixRow {
  const RunMode* mode = nullptr;
  const Fault* fault = nullptr;
  std::size_t severity = 0;
  std::array<const Cell*, kStages.size()> cells{};

  // The largest share of `limit` used in these cells, in percent, rounded up.
  [[nodiscard]] std::string Worst(const std::string& limit) const;
};
std::vector<MatrixRow> RowsOf(const Matrix& matrix);

// A cell's reaction, with each mode named once.
std::string ShortReaction(const Outcome& outcome);
// "recovered 1.2 s", "safe stop", "hold (reason)", "UNDEFINED: ..."; also exceeded limits and motion.
std::string EndInWords(const Outcome& outcome);
// Totals over all cells, one line each.
std::vector<std::string> TotalsInWords(const Matrix& matrix);

std::string ToTable(const Matrix& matrix);
std::string ToMarkdown(const Matrix& matrix);
std::string ToJson(const Matrix& matrix);

}  // namespace fovea::matrix
