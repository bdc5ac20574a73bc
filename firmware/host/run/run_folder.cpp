// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/run/run_folder.hpp"

#include <utility>
#include <vector>

namespace fovea::run {

RunFolder::RunFolder(RunFolderConfig config) : all_files_(RunBook::AllFiles(config.options.more_files)) {
  if (config.out.empty()) {
    return;
  }
  if (config.facts) {
    book_.emplace(config.out, *std::move(config.facts), std::move(config.options));
  } else {
    folder_.emplace(config.out);
  }
}

void RunFolder::Write(const std::string& summary_json, const linux_rt::DurationHistogram& ticks,
                      const RunBook::MoreFiles& more) {
  if (book_) {
    book_->Write(summary_json, ticks, more);
  } else if (folder_) {
    std::vector<config::OutputFile> files = more ? more() : std::vector<config::OutputFile>{};
    files.push_back({RunBook::kSummary, summary_json});
    folder_->Replace(files, all_files_);
  }
}

void RunFolder::KeepLog() const {
  if (book_) {
    book_->KeepLog();
  }
}

}  // namespace fovea::run
