// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/bench/common/html_text.hpp"
#include "tools/fovea/faults/text.hpp"

namespace fovea::matrix {
namespace {

using bench::Escaped;

constexpr const char* kStyle =
    "<style>main,.head{max-width:110rem}.matrix{overflow-x:auto;overflow-wrap:normal}.matrix "
    ".number{white-space:nowrap}.matrix "
    "td{vertical-align:top;font-size:.8rem;line-height:1.35}"
    ".matrix th{vertical-align:top}.matrix .quiet{opacity:.55}.matrix .notice{font-weight:600}"
    ".matrix .stop{border-left:3px solid #b26a00}.matrix .held{border-left:3px solid #5c6bc0}"
    ".matrix .bad{border-left:3px solid #c62828;font-weight:700}"
    ".matrix .fine{border-left:3px solid #2e7d32}</style>";

const char* ClassOf(const Outcome& o) {
  if (o.Failed()) {
    return "bad";
  }
  return o.end == End::kRecovered ? "fine" : o.end == End::kSafeStop ? "stop" : "held";
}

// HTML text that may wrap after each underscore.
std::string Breakable(const std::string& name) {
  std::string html;
  for (const char c : Escaped(name)) {
    html += c;
    html += c == '_' ? "<wbr>" : "";
  }
  return html;
}

std::string CellHtml(const Cell* cell) {
  if (cell == nullptr) {
    return "<td></td>";
  }
  const Outcome& o = cell->outcome;
  return fmt::format("<td class=\"{}\" title=\"{}\"><span class=\"{}\">{}</span><br>{}<br>{}</td>",
                     ClassOf(o), Escaped(cell->command), o.ticks ? "notice" : "quiet",
                     o.ticks ? Breakable(fmt::format("{}, {} ticks", o.noticed_by, *o.ticks)) : "not noticed",
                     Breakable(ShortReaction(o)), Escaped(EndInWords(o)));
}

std::string Banner(const Matrix& matrix) {
  const Totals t = Sum(matrix);
  std::string lines;
  for (const std::string& line : TotalsInWords(matrix)) {
    lines += "<li>" + Escaped(line) + "</li>";
  }
  return fmt::format(
      "<section id=\"verdict\"><div class=\"banner {}\"><div><p class=\"run-tag\">{} runs, seed {}</p><p "
      "class=\"verdict-word\">{} of {} cells passed</p><p class=\"verdict-sentence\">In {} cells a limit "
      "of the arm or of the servo was exceeded, in {} the arm moved while it had to stand, {} ended in no "
      "defined state.</p></div></div></section><section><h2>Totals</h2><ul>{}</ul></section>",
      t.Failed() ? "bad" : "good", matrix.runs, matrix.seed,
      std::count_if(matrix.cells.begin(), matrix.cells.end(),
                    [](const Cell& cell) { return !cell.outcome.Failed(); }),
      matrix.cells.size(), t.exceeded, t.moved, t.undefined, lines);
}

}  // namespace

std::string ToHtml(const Matrix& matrix) {
  std::string text = kStyle + Banner(matrix);
  const RunMode* mode = nullptr;
  for (const MatrixRow& row : RowsOf(matrix)) {
    if (row.mode != mode) {
      text += mode != nullptr ? "</tbody></table></section>" : "";
      mode = row.mode;
      text +=
          fmt::format("<section class=\"matrix\"><h2>{}: {}</h2><table><thead><tr><th>fault</th><th></th>",
                      mode->scenario, mode->title);
      for (const Stage stage : kStages) {
        text += fmt::format("<th>{}</th>", Name(stage));
      }
      for (const char* limit : {"q", "dq", "tau", "dtau"}) {
        text += fmt::format("<th class=\"number\">{}</th>", limit);
      }
      text += "</tr></thead><tbody>";
    }
    text += fmt::format("<tr><th scope=\"row\">{}</th><td>{}<br><span class=\"quiet\">{}</span></td>",
                        row.fault->name, kSeverities[row.severity],
                        Escaped(row.fault->levels[row.severity].figures));
    for (const Cell* cell : row.cells) {
      text += CellHtml(cell);
    }
    for (const std::string& limit : PhysicalLimits()) {
      text += fmt::format("<td class=\"number\">{}</td>", row.Worst(limit));
    }
    text += "</tr>";
  }
  return text + "</tbody></table></section>";
}

}  // namespace fovea::matrix
