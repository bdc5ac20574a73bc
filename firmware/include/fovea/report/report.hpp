// The report of a run, or of two beside each other: one HTML file that needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fovea/report/run_data.hpp"

namespace fovea::report {

// Of one run or two. `page_folder` holds the page's own parts. std::runtime_error when a part, or a library that is
// put into the page, is not there.
std::string MakeReport(const std::vector<RunData>& runs, const std::filesystem::path& page_folder);

// What the page's scripts read; see firmware/report/README.md.
std::string ToJson(const RunData& run);

}  // namespace fovea::report
