// One run per folder.
#pragma once

#include <filesystem>

namespace fovea::config {

// Holds `folder` for this process. The kernel lets go of it when the process ends, however it ends; no file
// is left behind. A file system that has no locks on folders (some network ones) gives no protection.
class FolderLock {
 public:
  // `folder` exists. InputError: another run holds it.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;  // -1: none
};

}  // namespace fovea::config
