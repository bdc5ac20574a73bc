// The folder of a run, or none: the summary alone, or all that a run leaves (RunBook). Whoever writes a
// summary.json writes it here.
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
  std::optional<RunFacts> facts;  // of log, film and report; none: these are left out
  RunBookOptions options;         // without facts only `more_files` counts
};

class RunFolder {
 public:
  // Holds the folder. InputError when nothing can be written there; std::runtime_error when the report's page
  // is not there.
  explicit RunFolder(RunFolderConfig config);

  // Null where there is no log.
  [[nodiscard]] RunBook* book() { return book_ ? &*book_ : nullptr; }

  // Once, after RunBook::EndFilm where there is a book: puts everything in place, with `more` of the run's
  // files before the summary. Throws what went wrong with any of it; then the folder is as it was, but for a
  // log that could not be written on: it stands there alone.
  void Write(const std::string& summary_json, const linux_rt::DurationHistogram& ticks = {},
             const RunBook::MoreFiles& more = {});
  // From any thread, when the process ends before Write is done: the log stands there alone, as far as it
  // goes.
  void KeepLog() const;

 private:
  const std::vector<std::string> all_files_;    // that such a run may leave, for the next to take away
  std::optional<RunBook> book_;                 // with log, film and report
  std::optional<config::OutputFolder> folder_;  // without
};

}  // namespace fovea::run
