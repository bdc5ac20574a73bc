// SPDX-License-Identifier: Apache-2.0
// The files of the live page, read once at the start: no request reaches the disk.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace fovea::live {

struct PageFile {
  std::string content;
  const char* type = "";  // its media type
};

class PageFiles {
 public:
  // Reads all files of `page`, as "/name"; those of `shared`, where it exists, as "/shared/name"; and those
  // of the system's JavaScript libraries that an .html file of `page` names as "lib/name".
  // std::runtime_error, naming the file, when index.html or a library is missing.
  PageFiles(const std::filesystem::path& page, const std::filesystem::path& shared);

  // `path`: of a request. Null when there is no such file.
  [[nodiscard]] const PageFile* Find(std::string_view path) const;

 private:
  void AddFolder(const std::filesystem::path& folder, const std::string& prefix);
  void AddLibrariesOf(const std::string& html);

  std::map<std::string, PageFile, std::less<>> files_;
};

}  // namespace fovea::live
