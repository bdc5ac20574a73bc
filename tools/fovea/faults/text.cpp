// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace fovea::matrix {
namespace {

constexpr std::size_t kModesShown = 5;  // of a reaction, to save space

std::vector<std::string> Parts(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t at = 0; (at = text.find(separator, from)) != std::string::npos;
       from = at + separator.size()) {
    parts.push_back(text.substr(from, at - from));
  }
  parts.push_back(text.substr(from));
  return parts;
}

std::string Percent(double share) {
  return fmt::format("{:.0f} %", std::max(0.0, std::ceil(100.0 * share - 1e-7)));
}

std::string Notice(const Outcome& o) {
  return o.ticks ? fmt::format("{} {}", o.noticed_by, *o.ticks) : std::string("-");
}

}  // namespace

std::string MatrixRow::Worst(const std::string& limit) const {
  double most = -1.0;
  for (const Cell* cell : cells) {
    if (cell != nullptr && cell->outcome.limits.count(limit) > 0) {
      most = std::max(most, cell->outcome.limits.at(limit));
    }
  }
  return most < 0.0 ? "-" : Percent(most);
}

std::vector<MatrixRow> RowsOf(const Matrix& matrix) {
  std::vector<MatrixRow> rows;
  for (const Cell& cell : matrix.cells) {
    if (rows.empty() || rows.back().mode != cell.mode || rows.back().fault != cell.fault ||
        rows.back().severity != cell.severity) {
      rows.push_back({cell.mode, cell.fault, cell.severity, {}});
    }
    rows.back().cells[static_cast<std::size_t>(cell.stage)] = &cell;
  }
  return rows;
}

std::string ShortReaction(const Outcome& o) {
  if (o.reaction.empty()) {
    return "none";
  }
  std::vector<std::string> once;
  for (const std::string& part : Parts(o.reaction, ", ")) {
    if (std::find(once.begin(), once.end(), part) == once.end()) {
      once.push_back(part);
    }
  }
  const bool all = once.size() <= kModesShown;
  once.resize(std::min(once.size(), kModesShown));
  return fmt::format("{}{}", fmt::join(once, ", "), all ? "" : ", ...");
}

std::string EndInWords(const Outcome& o) {
  std::string words = Name(o.end);
  if (o.end == End::kUndefined) {
    words = fmt::format("UNDEFINED: {}", o.end_detail);
  } else if (o.end == End::kHeld) {
    words = o.end_detail;
  } else if (o.end == End::kGoesOn) {
    words = fmt::format("goes on, {:.1f} mm off", *o.off_mm);
  }
  if (o.recovered_after_s && *o.recovered_after_s > 0.0) {
    words += fmt::format(" {:.1f} s", *o.recovered_after_s);
  }
  if (!o.exceeded.empty()) {
    words += fmt::format(" EXCEEDED {}", fmt::join(o.exceeded, ", "));
  }
  if (!o.too_far.empty()) {
    words += fmt::format(" MOVED {}", fmt::join(o.too_far, "; "));
  }
  return words;
}

std::vector<std::string> TotalsInWords(const Matrix& matrix) {
  const Totals t = Sum(matrix);
  std::vector<std::string> lines{
      fmt::format(
          "{} cells: {} recovered, {} safe stops, {} held, {} went on, {} undefined; a limit exceeded in {}",
          matrix.cells.size(), t.recovered, t.stopped, t.held, t.gone_on, t.undefined, t.exceeded),
      fmt::format("the arm moved too far or too fast while it should have stood in {}", t.moved),
      fmt::format("noticed in {}, slowest after {} ticks ({})", t.noticed,
                  t.slowest != nullptr ? *t.slowest->outcome.ticks : 0,
                  t.slowest != nullptr ? NameOf(*t.slowest) : "-"),
      fmt::format("the arm touched bench, target or itself in {}", t.touched)};
  if (t.last != nullptr) {
    lines.push_back(
        fmt::format("the slowest recovery took {:.1f} s from the fault's end ({}); runs with extra time: {}",
                    *t.last->outcome.recovered_after_s, NameOf(*t.last), t.longer));
  }
  for (const auto& [mode, cell] : t.furthest) {
    const Moved& way = cell->outcome.moved.at(mode);
    lines.push_back(fmt::format("in {} the hand went at most {:.0f} mm, {:.0f} mm beyond a stop ({})", mode,
                                way.mm, way.beyond_stop_mm, NameOf(*cell)));
  }
  for (const auto& [limit, cell] : t.worst_limits) {
    lines.push_back(
        fmt::format("{}: at most {} ({})", limit, Percent(cell->outcome.limits.at(limit)), NameOf(*cell)));
  }
  return lines;
}

std::string ToTable(const Matrix& matrix) {
  // Two lines per cell: its name and end; then what noticed the fault, the reaction, and the limits used.
  std::string text = fmt::format("{:<46} {}\n  {:<26} {:<40} {:>6} {:>6} {:>6} {:>6}\n", "cell", "end",
                                 "noticed by, ticks", "reaction", "q", "dq", "tau", "dtau");
  for (const Cell& cell : matrix.cells) {
    const Outcome& o = cell.outcome;
    text +=
        fmt::format("{:<46} {}\n  {:<26} {:<40}", NameOf(cell), EndInWords(o), Notice(o), ShortReaction(o));
    for (const std::string& limit : PhysicalLimits()) {
      text += fmt::format(" {:>6}", o.limits.count(limit) > 0 ? Percent(o.limits.at(limit)) : "-");
    }
    text += "\n";
  }
  for (const std::string& line : TotalsInWords(matrix)) {
    text += fmt::format("{}\n", line);
  }
  for (const Cell& cell : matrix.cells) {
    if (cell.outcome.Failed()) {
      text += fmt::format("{}: {}\n  {}\n", NameOf(cell), EndInWords(cell.outcome), cell.command);
    }
  }
  return text;
}

std::string ToJson(const Matrix& matrix) {
  using Json = nlohmann::ordered_json;
  const Totals t = Sum(matrix);
  Json cells = Json::array();
  for (const Cell& cell : matrix.cells) {
    const Outcome& o = cell.outcome;
    Json moved = Json::object();
    for (const auto& [mode, way] : o.moved) {
      moved[mode] = {
          {"mm", way.mm}, {"beyond_stop_mm", way.beyond_stop_mm}, {"gained_m_per_s", way.gained_m_per_s}};
    }
    cells.push_back({{"mode", cell.mode->name},
                     {"stage", Name(cell.stage)},
                     {"fault", cell.fault->id},
                     {"severity", kSeverities[cell.severity]},
                     {"onset_s", cell.onset_s},
                     {"noticed_by", o.ticks ? Json(o.noticed_by) : Json(nullptr)},
                     {"ticks", o.ticks ? Json(*o.ticks) : Json(nullptr)},
                     {"reaction", o.reaction},
                     {"limits", o.limits},
                     {"exceeded", o.exceeded},
                     {"moved", moved},
                     {"too_far", o.too_far},
                     {"contact_ticks", o.contact_ticks},
                     {"end", Name(o.end)},
                     {"end_detail", o.end_detail},
                     {"off_mm", o.off_mm ? Json(*o.off_mm) : Json(nullptr)},
                     {"recovered_after_s", o.recovered_after_s ? Json(*o.recovered_after_s) : Json(nullptr)},
                     {"command", cell.command}});
  }
  Json json;
  json["seed"] = matrix.seed;
  json["runs"] = matrix.runs;
  json["recovered"] = t.recovered;
  json["safe_stops"] = t.stopped;
  json["held"] = t.held;
  json["gone_on"] = t.gone_on;
  json["undefined"] = t.undefined;
  json["exceeded"] = t.exceeded;
  json["moved_too_far"] = t.moved;
  json["touched"] = t.touched;
  json["given_longer"] = t.longer;
  json["slowest_ticks"] = t.slowest != nullptr ? Json(*t.slowest->outcome.ticks) : Json(nullptr);
  for (const auto& [limit, cell] : t.worst_limits) {
    json["worst_limits"][limit] = {{"share", cell->outcome.limits.at(limit)}, {"cell", NameOf(*cell)}};
  }
  json["cells"] = cells;
  return json.dump(2) + "\n";
}

}  // namespace fovea::matrix
