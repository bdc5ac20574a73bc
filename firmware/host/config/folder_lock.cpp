// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {

// Closed on exec: a child that outlives the run must not keep the lock.
FolderLock::FolderLock(const std::filesystem::path& folder)
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(file_);
    throw InputError("--out " + folder.string() +
                     ": another run writes there; choose a folder that no run uses");
  }
}

FolderLock::~FolderLock() {
  if (file_ >= 0) {
    close(file_);
  }
}

}  // namespace fovea::config
