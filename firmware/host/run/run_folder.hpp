// SPDX-License-Identifier: Apache-2.0
// The folder of a run, or none: with only the summary, or with all files of a run (RunBook). Every program
// writes its summary.json through this class.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "firmware/host/config/output_folder.hpp"
#include "firmware/host/run/run_book.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::run {

struct RunFolderConfig {
  std::filesystem::path out;      // empty: no files
  std::optional<RunFacts> facts;  // for log, film and report; none: these are left out
  RunBookOptions options;         // without facts only `more_files` counts
};

class RunFolder {
 public:
  // Locks the folder. InputError when nothing can be written there; std::runtime_error when the report's page
  // is missing.
  explicit RunFolder(RunFolderConfig config);

  // Null if there is no log.
  [[nodiscard]] RunBook* book() { return book_ ? &*book_ : nullptr; }

  // Call once, after RunBook::EndFilm if there is a book: puts all files in place, with the files of `more`
  // before the summary. Throws any error. Then the folder contains only the log, complete or up to where
  // writing it failed; a folder without a log is unchanged.
  void Write(const std::string& summary_json, const linux_rt::DurationHistogram& ticks = {},
             const RunBook::MoreFiles& more = {});
  // From any thread, when the process ends before Write is done: keeps only the incomplete log.
  void KeepLog() const;

 private:
  const std::vector<std::string> all_files_;    // that such a run may leave, for the next run to remove
  std::optional<RunBook> book_;                 // with log, film and report
  std::optional<config::OutputFolder> folder_;  // without
};

}  // namespace fovea::run
