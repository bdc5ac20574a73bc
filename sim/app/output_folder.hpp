// The folder that a run leaves its files in. A file is there whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::sim {

class OutputFolder {
 public:
  // Makes the folder, and makes sure that files can be written to it. InputError when they cannot.
  explicit OutputFolder(const std::filesystem::path& folder);

  // Puts a file there under its name in one move, replacing an older one. InputError when it cannot.
  void Write(const std::string& name, const std::string& content) const;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace fovea::sim
