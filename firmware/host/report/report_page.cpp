// SPDX-License-Identifier: Apache-2.0
// Assembles the page: replaces the template's marks by the files that they name, and by the runs' data.

#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "firmware/host/report/report.hpp"

namespace fovea::report {
namespace {

namespace fs = std::filesystem;

std::string ReadFile(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw std::runtime_error(path.string() + ": missing; the report needs it");
  }
  return {std::istreambuf_iterator<char>(stream), {}};
}

void ReplaceAll(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// Removes the lines that name a library's source map: the page does not contain that file.
std::string WithoutSourceMap(std::string text) {
  constexpr std::string_view kMark = "# sourceMappingURL=";
  for (std::size_t at = text.find(kMark); at != std::string::npos; at = text.find(kMark)) {
    const std::size_t line = text.rfind('\n', at) + 1;  // 0 when it is the first
    text.erase(line, text.find('\n', at) - line);
  }
  return text;
}

// Text within <script> ends at the first "</script", so the text must not contain it.
std::string InScript(std::string text) {
  ReplaceAll(text, "</script", "<\\/script");
  ReplaceAll(text, "<!--", "<\\!--");
  return text;
}

std::string Escaped(std::string text) {
  ReplaceAll(text, "&", "&amp;");
  ReplaceAll(text, "<", "&lt;");
  return text;
}

}  // namespace

ReportPage::ReportPage(const fs::path& folder, const std::string& page) {
  const fs::path libraries = FOVEA_JAVASCRIPT_FOLDER;
  std::string* part = &before_data_;
  std::istringstream lines(ReadFile(folder / page));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string mark;
    std::string kind;
    words >> mark >> kind;
    if (mark != "<!--" || kind.rfind("FOVEA:", 0) != 0) {
      *part += line + "\n";
      continue;
    }
    if (kind == "FOVEA:DATA") {
      part = &after_data_;
      continue;
    }
    const bool is_style = kind == "FOVEA:STYLE";
    for (std::string name; words >> name && name != "-->";) {
      const bool is_library = name.rfind("lib:", 0) == 0;
      const std::string text =
          WithoutSourceMap(ReadFile(is_library ? libraries / name.substr(4) : folder / name));
      *part += is_style ? "<style>\n" + text + "</style>\n" : "<script>\n" + InScript(text) + "</script>\n";
    }
  }
}

std::string ReportPage::Make(const std::vector<RunData>& runs) const {
  std::string title = runs.front().name;
  if (runs.size() > 1) {
    title += " and " + runs[1].name;
  }
  std::vector<std::string> jsons;
  jsons.reserve(runs.size());
  for (const RunData& run : runs) {
    jsons.push_back(ToJson(run));
  }
  return Make(title, jsons);
}

std::string ReportPage::Make(const std::string& title, const std::vector<std::string>& runs) const {
  std::string page = before_data_;
  ReplaceAll(page, "FOVEA_TITLE", Escaped(title));
  for (std::string json : runs) {
    ReplaceAll(json, "</", "<\\/");
    ReplaceAll(json, "<!--", "\\u003c!--");
    page += "<script type=\"application/json\" class=\"fovea-run\">" + json + "</script>\n";
  }
  return page + after_data_;
}

}  // namespace fovea::report
