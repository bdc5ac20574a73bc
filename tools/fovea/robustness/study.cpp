// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/study.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/fovea/robustness/bisection.hpp"

namespace fovea::robustness {
namespace {

using atlas::Batch;
using atlas::Case;

const Case kNone{"none", {}, false};

Case CaseOf(const Bar& bar, Side side, double multiple) {
  return {CaseName(bar, side, multiple), {AssignmentOf(bar, side, multiple)}, multiple != 1.0};
}

bool IsGood(const atlas::Row& row) {
  return row.converged && row.limit_violations == 0 && row.contact_ticks == 0;
}

// The search for one margin.
struct Search {
  const Bar* bar = nullptr;
  Side side{};
  Bisection bisection{MarginMultiples().size(), kStatedMultiple};

  [[nodiscard]] Case At(std::size_t i) const { return CaseOf(*bar, side, MarginMultiples().at(i)); }
};

// The first of `starts` that is lost; null if none is.
const atlas::Row* FirstLost(const Batch& batch, const Case& truth, const std::vector<int>& starts) {
  for (const int start : starts) {
    const atlas::Row& row = batch.rows(truth.name).at(start);
    if (!IsGood(row)) {
      return &row;
    }
  }
  return nullptr;
}

Margin MarginOf(const Batch& batch, const Search& search, const std::vector<int>& starts) {
  Margin margin;
  if (const auto borne = search.bisection.borne()) {
    margin.borne = MarginMultiples().at(*borne);
  }
  if (const auto not_borne = search.bisection.not_borne()) {
    const atlas::Row& row = *FirstLost(batch, search.At(*not_borne), starts);
    margin.is_end = row.refused;
    margin.why = row.verdict;
    if (!row.refused) {
      margin.lost = MarginMultiples().at(*not_borne);
      margin.command = atlas::CommandOf(batch.heading(), batch.scenario(), row);
    }
  }
  return margin;
}

void FindMargins(Batch& batch, int starts, std::vector<BarFigures>& bars) {
  std::vector<int> good;
  for (int start = 0; start < starts; ++start) {
    if (IsGood(batch.rows(kNone.name).at(start))) {
      good.push_back(start);
    }
  }
  if (good.empty()) {
    return;
  }
  std::vector<Search> searches;
  for (const BarFigures& one : bars) {
    for (const Side side : kSides) {
      if (one.sides.at(static_cast<std::size_t>(side))) {
        searches.push_back({&one.bar, side});
      }
    }
  }
  for (int round = 1;; ++round) {
    std::vector<Case> cases;
    for (const Search& search : searches) {
      if (const auto next = search.bisection.Next()) {
        cases.push_back(search.At(*next));
      }
    }
    if (cases.empty()) {
      break;
    }
    atlas::Progress progress(fmt::format("{}, margins, round {}", batch.heading().target, round),
                             static_cast<int>(cases.size()) * starts);
    batch.Execute(cases, starts, progress);
    for (Search& search : searches) {
      if (const auto next = search.bisection.Next()) {
        search.bisection.Note(FirstLost(batch, search.At(*next), good) == nullptr);
      }
    }
  }
  auto search = searches.begin();
  for (BarFigures& one : bars) {
    for (std::optional<SideFigures>& side : one.sides) {
      if (side) {
        side->margin = MarginOf(batch, *search++, good);
      }
    }
  }
}

}  // namespace

std::vector<SizeFigures> RunSizes(Batch& batch, const Spec& spec, const std::vector<double>& sizes,
                                  int runs) {
  std::vector<Case> cases;
  for (const double size : sizes) {
    cases.push_back({fmt::format("size-{}", size), Scaled(spec, size), false});
    batch.Try(cases.back(), fmt::format("{} at size {:g}", spec.name, size));
  }
  atlas::Progress progress(batch.heading().target + ", sizes", static_cast<int>(cases.size()) * runs);
  batch.Execute(cases, runs, progress);
  progress.End();
  batch.JudgeFailures(cases, runs);
  std::vector<SizeFigures> figures;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    figures.push_back({sizes[i], batch.FiguresOf(cases[i].name, runs)});
  }
  return figures;
}

Tornado RunTornado(Batch& batch, const Spec& spec, int runs, int starts, bool with_margins) {
  const Case all{"all", Scaled(spec, 1.0), false};
  const std::vector<Bar> bars = BarsOf(spec, batch.Try(all, spec.name));
  starts = std::min(starts, runs);
  std::vector<Case> alone;
  for (const Bar& bar : bars) {
    for (const Side side : kSides) {
      if (EndOf(bar, side) != 0.0) {
        alone.push_back(CaseOf(bar, side, 1.0));
      }
    }
  }
  const std::string& target = batch.heading().target;
  {
    atlas::Progress progress(target + ", none and all", 2 * runs);
    batch.Execute({kNone, all}, runs, progress);
  }
  {
    atlas::Progress progress(target + ", each alone", static_cast<int>(alone.size()) * starts);
    batch.Execute(alone, starts, progress);
  }
  std::vector<Case> stated = alone;
  stated.push_back(kNone);
  stated.push_back(all);
  batch.JudgeFailures(stated, runs);
  Tornado tornado{batch.FiguresOf(kNone.name, runs),
                  batch.FiguresOf(kNone.name, starts),
                  batch.FiguresOf(all.name, runs),
                  {},
                  starts};
  for (const Bar& bar : bars) {
    BarFigures one{bar, {}};
    for (const Side side : kSides) {
      if (EndOf(bar, side) != 0.0) {
        one.sides.at(static_cast<std::size_t>(side)) =
            SideFigures{batch.FiguresOf(CaseName(bar, side, 1.0), starts), std::nullopt};
      }
    }
    tornado.bars.push_back(std::move(one));
  }
  if (with_margins) {
    FindMargins(batch, starts, tornado.bars);
  }
  return tornado;
}

}  // namespace fovea::robustness
