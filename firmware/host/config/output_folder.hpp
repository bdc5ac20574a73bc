// SPDX-License-Identifier: Apache-2.0
// The output folder of a run. A file in it is complete or absent.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/folder_lock.hpp"

namespace fovea::config {

struct OutputFile {
  std::string name;
  std::optional<std::string> content;  // none: the run wrote it to the path that Begin returned
};

class OutputFolder {
 public:
  // Makes and locks the folder, and checks that it can be written to. InputError when it cannot, or when
  // another run holds it.
  explicit OutputFolder(const std::filesystem::path& folder);
  // Removes files that were begun and not put in place.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Returns a path for writing the file `name` during the run; Replace puts the file in place.
  std::filesystem::path Begin(const std::string& name);

  // Replaces the files of an earlier run, named in `all_names`, by `files`. InputError when a file cannot be
  // written; the earlier files then stay, and those of Begin. The last of `files` appears last: where it
  // exists, the others exist too.
  void Replace(const std::vector<OutputFile>& files, const std::vector<std::string>& all_names) const;

  // Puts the file `name` of Begin in place, complete or not, and removes an earlier run's files, named in
  // `all_names`. For a file that must survive when Replace is impossible. Returns its path. Any thread may
  // call it, also during Replace; it does nothing once Replace has put `name` in place.
  std::filesystem::path Keep(const std::string& name, const std::vector<std::string>& all_names) const;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  [[nodiscard]] std::filesystem::path Partial(const std::string& name) const;
  [[nodiscard]] std::filesystem::path Earlier(const std::string& name) const;  // while Replace may fail
  void WritePartial(const OutputFile& file) const;
  // Undoes a Replace in which a rename failed. Begun files go back to their paths of Begin.
  void TakeBack(const std::vector<OutputFile>& files, const std::vector<std::string>& all_names) const;

  std::filesystem::path folder_;
  std::optional<FolderLock> lock_;
  std::vector<std::string> begun_;
  mutable std::mutex placing_;  // held while files are removed and renamed
};

}  // namespace fovea::config
