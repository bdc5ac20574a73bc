// The folder that a run leaves its files in. A file is there whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fovea::sim {

struct OutputFile {
  std::string name;
  std::string content;
};

class OutputFolder {
 public:
  // Makes the folder, and makes sure that files can be written to it. InputError when they cannot.
  explicit OutputFolder(const std::filesystem::path& folder);

  // Puts `files` there, in place of what an earlier run left under `all_names`. When one cannot be written,
  // InputError, and everything is as it was. The last of `files` appears after all the others: where it is,
  // the rest is too.
  void Replace(const std::vector<OutputFile>& files, const std::vector<std::string>& all_names) const;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  [[nodiscard]] std::filesystem::path Partial(const OutputFile& file) const;
  void WritePartial(const OutputFile& file) const;

  std::filesystem::path folder_;
};

}  // namespace fovea::sim
