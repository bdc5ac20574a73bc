// The folder that a run leaves its files in. A file is there whole or not at all.
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
  std::optional<std::string> content;  // none: what was written to the path that Begin gave
};

class OutputFolder {
 public:
  // Makes the folder, holds it, and makes sure that files can be written to it. InputError when they cannot,
  // or when another run holds it.
  explicit OutputFolder(const std::filesystem::path& folder);
  // Removes what was begun and not put in place.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // A path to write the file `name` to while the run goes on; Replace puts it in place.
  std::filesystem::path Begin(const std::string& name);

  // Puts `files` there, in place of what an earlier run left under `all_names`. When one cannot be written,
  // InputError, and everything is as it was. The last of `files` appears after all the others: where it is,
  // the rest is too.
  void Replace(const std::vector<OutputFile>& files, const std::vector<std::string>& all_names) const;

  // Puts in place what was written to the path that Begin gave for `name`, as far as it goes, and takes away
  // what an earlier run left under `all_names`. For what shall outlive a Replace that cannot be. Returns its
  // path. Any thread may call it, during a Replace too; once that has put `name` in place, nothing is done.
  std::filesystem::path Keep(const std::string& name, const std::vector<std::string>& all_names) const;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  [[nodiscard]] std::filesystem::path Partial(const std::string& name) const;
  void WritePartial(const OutputFile& file) const;

  std::filesystem::path folder_;
  std::optional<FolderLock> lock_;
  std::vector<std::string> begun_;
  mutable std::mutex placing_;  // while names change
};

}  // namespace fovea::config
