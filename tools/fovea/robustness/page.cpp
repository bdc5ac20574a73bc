// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/page.hpp"

#include <fmt/format.h>

#include "tools/bench/common/html_text.hpp"
#include "tools/fovea/robustness/chart.hpp"
#include "tools/fovea/robustness/text.hpp"

namespace fovea::robustness {
namespace {

using atlas::Failure;
using atlas::Figures;
using bench::Escaped;

// A wide table scrolls in its own frame.
constexpr const char* kStyle =
    "<style>.wide{overflow-x:auto}.wide td,.wide th{white-space:nowrap;vertical-align:top}"
    ".swatch{display:inline-block;width:1em;height:.8em;border:1px solid var(--ink)}</style>";

std::string Section(const std::string& title, const std::string& content) {
  return fmt::format("<section><h2>{}</h2>{}</section>", Escaped(title), content);
}

std::string Table(const std::string& caption, const std::string& head, const std::string& rows) {
  return fmt::format(
      "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table><caption "
      "class=\"hint\">{0}</caption><thead><tr>{1}</tr></thead><tbody>{2}</tbody></table></div>",
      Escaped(caption), head, rows);
}

std::string Heads(const std::vector<const char*>& names) {
  std::string text;
  for (const char* name : names) {
    text += fmt::format("<th scope=\"col\">{}</th>", name);
  }
  return text;
}

std::string FigureCells(const Figures& f) {
  return fmt::format("<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", SuccessOf(f),
                     MedianAndMost(f.error_px), MedianAndMost(f.error_mm), MedianAndMost(f.settle_s),
                     f.limit_violations, f.contact_runs);
}

const std::vector<const char*> kFigureHeads{
    "converged (Wilson, 95 %)",  "image [px], median; most", "position [mm], median; most",
    "settled [s], median; most", "limit violations",         "runs with contact"};

std::string HeadsWith(std::vector<const char*> first) {
  first.insert(first.end(), kFigureHeads.begin(), kFigureHeads.end());
  return Heads(first);
}

std::string FailureRows(const std::string& name, const Figures& f) {
  std::string rows;
  for (const Failure& failure : f.failures) {
    rows += fmt::format(
        "<tr><th scope=\"row\">{}, run {}</th><td style=\"white-space:normal\">{}<code class=\"listing\" "
        "style=\"display:block\">{}</code></td></tr>",
        Escaped(name), failure.index, Escaped(failure.verdict), Escaped(failure.command));
  }
  return rows;
}

std::string Failures(const std::string& rows) {
  return Section("Failures", rows.empty() ? "<p>None.</p>"
                                          : Table("Failed runs within the stated sizes",
                                                  Heads({"run", "verdict and command"}), rows));
}

std::string Banner(const Spec& spec, const Figures& f, const std::string& word, bool is_good,
                   const std::string& sentence) {
  std::string truth;
  for (const std::string& assignment : Scaled(spec, 1.0)) {
    truth += fmt::format("<li><code>{}</code></li>", Escaped(assignment));
  }
  return fmt::format(
      "{}<section id=\"verdict\"><div class=\"banner {}\"><div><p class=\"run-tag\">seed {}, {}</p><p "
      "class=\"verdict-word\">{}</p><p "
      "class=\"verdict-sentence\">{}</p></div></div></section><section><h2>What is "
      "not as the servo believes</h2><ul>{}</ul></section>",
      kStyle, is_good ? "good" : "bad", f.heading.seed, Escaped(spec.name), Escaped(word), Escaped(sentence),
      truth);
}

std::string Charts(const Tornado& tornado) {
  std::string figures;
  for (const Measure& measure : Measures()) {
    figures += fmt::format("<figure><h3>{}</h3>{}</figure>", measure.name, TornadoChart(tornado, measure));
  }
  return fmt::format(
      "<p class=\"hint\"><span class=\"swatch\" style=\"background:#8ec4de\"></span> at the low stated end, "
      "<span "
      "class=\"swatch\" style=\"background:#0d3261\"></span> at the high one. Each bar begins at the median "
      "without "
      "errors and ends at the median with one (starts: {}); the thin line ends at the largest value. Dashed: "
      "the "
      "median with "
      "all quantities together.</p><div class=\"columns\">{}</div>",
      tornado.starts, figures);
}

std::string BarRows(const Tornado& tornado) {
  std::string rows;
  for (const BarFigures* one : ByCost(tornado)) {
    for (const Side side : kSides) {
      const auto& at = one->sides.at(static_cast<std::size_t>(side));
      if (at) {
        const Amount amount = AmountOf(one->bar, side, 1.0);
        rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{:+.3g} {}</td>{}<td>{}</td></tr>",
                            Escaped(NameOf(one->bar)), amount.number, Escaped(amount.unit),
                            FigureCells(at->stated), Escaped(BorneRange(*one)));
      }
    }
  }
  return rows;
}

}  // namespace

std::string ToHtml(const Spec& spec, const std::vector<SizeFigures>& sizes) {
  std::string rows;
  std::string failures;
  bool is_good = true;
  for (const SizeFigures& one : sizes) {
    rows += fmt::format("<tr><th scope=\"row\">{:g}</th>{}</tr>", one.size, FigureCells(one.figures));
    failures += FailureRows(fmt::format("size {:g}", one.size), one.figures);
    is_good = is_good && (one.size > 1.0 || one.figures.ReachedGoal());
  }
  std::string figures = fmt::format("<figure><h3>Success</h3>{}</figure>", SuccessChart(sizes));
  for (const Measure& measure : Measures()) {
    figures += fmt::format("<figure><h3>{}</h3>{}</figure>", measure.name, MeasureChart(sizes, measure));
  }
  return Banner(spec, sizes.front().figures,
                fmt::format("{} sizes of {} runs", sizes.size(), sizes.front().figures.runs), is_good,
                is_good ? "Up to the stated size, the runs reach their goal."
                        : "A run within the stated size failed.") +
         Section(
             "Results over the size of all differences",
             fmt::format("<p class=\"hint\">Lines: Wilson's interval of 95 %; from the median to the largest "
                         "value of the converged runs.</p><div class=\"columns\">{}</div>{}",
                         figures, Table("Results at each size", HeadsWith({"size"}), rows))) +
         Failures(failures);
}

std::string ToHtml(const Spec& spec, const std::vector<Tornado>& targets) {
  std::string text;
  std::string failures;
  bool is_good = true;
  for (const Tornado& tornado : targets) {
    is_good = is_good && KeepsLimits(tornado);
    const std::string& target = tornado.none.heading.target;
    std::string rows;
    for (const auto& [name, f] :
         {std::pair<const char*, const Figures&>{"none", tornado.none}, {"all together", tornado.all}}) {
      rows += fmt::format("<tr><th scope=\"row\">{}</th><td></td>{}<td></td></tr>", name, FigureCells(f));
      failures += FailureRows(target + ", " + name, f);
    }
    rows += BarRows(tornado);
    for (const BarFigures& one : tornado.bars) {
      for (const auto& side : one.sides) {
        failures += side ? FailureRows(target + ", " + NameOf(one.bar), side->stated) : "";
      }
    }
    std::vector<const char*> heads{"quantity", "stated"};
    heads.insert(heads.end(), kFigureHeads.begin(), kFigureHeads.end());
    heads.push_back("borne");
    text += Section(target + ": which error costs most",
                    Charts(tornado) + Table("Results of each quantity alone: " + target, Heads(heads), rows));
  }
  return Banner(spec, targets.front().none,
                is_good ? "No limit exceeded, no contact"
                        : "A limit exceeded, a contact, or a run without a result",
                is_good, "Within the stated ends, each quantity alone and all together.") +
         text + Failures(failures);
}

}  // namespace fovea::robustness
