// The report of a run, or of two beside each other: one HTML file that needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fovea/report/run_data.hpp"

namespace fovea::report {

class ReportPage {
 public:
  // Reads the page's own parts from `folder`, and the libraries that are put into it. std::runtime_error,
  // naming the file, when one is not there.
  explicit ReportPage(const std::filesystem::path& folder);

  // The whole file, for one run or two.
  [[nodiscard]] std::string Make(const std::vector<RunData>& runs) const;

 private:
  std::string before_data_;
  std::string after_data_;
};

// What the page's scripts read; see firmware/report/README.md.
std::string ToJson(const RunData& run);

}  // namespace fovea::report
