// SPDX-License-Identifier: Apache-2.0
// The report of one run, or of two runs side by side: one self-contained HTML file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/report/run_data.hpp"

namespace fovea::report {

class ReportPage {
 public:
  // Reads the template `page` from `folder`, and the parts and libraries that it names. std::runtime_error,
  // naming the file, when one is missing.
  explicit ReportPage(const std::filesystem::path& folder, const std::string& page = "report.html");

  // The whole file, for one run or two.
  [[nodiscard]] std::string Make(const std::vector<RunData>& runs) const;
  // The same for another page. `runs`: for each run the JSON text that the page's script reads.
  [[nodiscard]] std::string Make(const std::string& title, const std::vector<std::string>& runs) const;

 private:
  std::string before_data_;
  std::string after_data_;
};

// The JSON text that the page's scripts read; see firmware/host/report/README.md.
std::string ToJson(const RunData& run);

}  // namespace fovea::report
