// The report of a run, or of two beside each other: one HTML file that needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/report/run_data.hpp"

namespace fovea::report {

class ReportPage {
 public:
  // Reads the page's own parts from `folder`, where `page` names them, and the libraries that are put into
  // it. std::runtime_error, naming the file, when one is not there.
  explicit ReportPage(const std::filesystem::path& folder, const std::string& page = "report.html");

  // The whole file, for one run or two.
  [[nodiscard]] std::string Make(const std::vector<RunData>& runs) const;
  // The same, of what another page's script reads: a JSON text for each run.
  [[nodiscard]] std::string Make(const std::string& title, const std::vector<std::string>& runs) const;

 private:
  std::string before_data_;
  std::string after_data_;
};

// What the page's scripts read; see firmware/host/report/README.md.
std::string ToJson(const RunData& run);

}  // namespace fovea::report
