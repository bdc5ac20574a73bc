// A fault matrix for people and machines: a line per cell, a page of Markdown, JSON.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/fovea/faults/matrix.hpp"

namespace fovea::matrix {

// The cells of one fault at one severity in one mode, by stage; null where it makes no sense or was not
// asked.
struct MatrixRow {
  const RunMode* mode = nullptr;
  const Fault* fault = nullptr;
  std::size_t severity = 0;
  std::array<const Cell*, kStages.size()> cells{};

  // The largest share of `limit` used in any of them, in percent as it is printed: rounded up, so that
  // nothing below 100 looks like it.
  [[nodiscard]] std::string Worst(const std::string& limit) const;
};
std::vector<MatrixRow> RowsOf(const Matrix& matrix);

// A cell's reaction, each mode said once.
std::string ShortReaction(const Outcome& outcome);
// "recovered 1.2 s", "safe stop", "held", "UNDEFINED"; with what was exceeded and how far it moved.
std::string EndInWords(const Outcome& outcome);
// What all came to, in a sentence or two, each a line.
std::vector<std::string> TotalsInWords(const Matrix& matrix);

std::string ToTable(const Matrix& matrix);
std::string ToMarkdown(const Matrix& matrix);
std::string ToJson(const Matrix& matrix);

}  // namespace fovea::matrix
