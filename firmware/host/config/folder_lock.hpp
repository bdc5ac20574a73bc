// SPDX-License-Identifier: Apache-2.0
// Allows one run per folder.
#pragma once

#include <filesystem>

namespace fovea::config {

// Locks `folder` for this process. The kernel releases the lock when the process ends, also after a crash; no
// file is left behind. A file system without locks on folders (some network ones) gives no protection.
class FolderLock {
 public:
  // `folder` must exist. InputError: another run holds it.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;  // -1: none
};

}  // namespace fovea::config
