// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/output_folder.hpp"

#include <unistd.h>

#include <fstream>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(const fs::path& folder) : folder_(folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_)) {
    throw InputError("--out " + folder_.string() + ": the folder cannot be made: " +
                     (error ? error.message() : "something else has that name"));
  }
  if (access(folder_.c_str(), W_OK | X_OK) != 0) {
    throw InputError("--out " + folder_.string() + ": the folder cannot be written to");
  }
  lock_.emplace(folder_);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (const std::string& name : begun_) {
    fs::remove(Partial(name), ignored);
  }
}

fs::path OutputFolder::Begin(const std::string& name) {
  begun_.push_back(name);
  return Partial(name);
}

fs::path OutputFolder::Partial(const std::string& name) const { return folder_ / ("." + name + ".partial"); }
fs::path OutputFolder::Earlier(const std::string& name) const { return folder_ / ("." + name + ".earlier"); }

void OutputFolder::WritePartial(const OutputFile& file) const {
  std::error_code ignored;
  if (fs::is_directory(folder_ / file.name, ignored)) {
    throw InputError((folder_ / file.name).string() + ": cannot be written: a folder has that name");
  }
  if (!file.content) {
    return;
  }
  std::ofstream stream(Partial(file.name), std::ios::binary | std::ios::trunc);
  stream.write(file.content->data(), static_cast<std::streamsize>(file.content->size()));
  stream.close();
  if (!stream) {
    throw InputError((folder_ / file.name).string() + ": cannot be written (is the disk full?)");
  }
}

fs::path OutputFolder::Keep(const std::string& name, const std::vector<std::string>& all_names) const {
  const std::lock_guard lock(placing_);
  std::error_code ignored;
  if (!fs::exists(Partial(name), ignored)) {
    return folder_ / name;
  }
  for (const std::string& other : all_names) {
    if (!fs::is_directory(folder_ / other, ignored)) {  // that is no run's file
      fs::remove(folder_ / other, ignored);
    }
  }
  fs::rename(Partial(name), folder_ / name, ignored);
  return folder_ / name;
}

void OutputFolder::TakeBack(const std::vector<OutputFile>& files,
                            const std::vector<std::string>& all_names) const {
  std::error_code ignored;
  for (const OutputFile& file : files) {
    if (file.content) {
      fs::remove(folder_ / file.name, ignored);
      fs::remove(Partial(file.name), ignored);
    } else {
      fs::rename(folder_ / file.name, Partial(file.name), ignored);
    }
  }
  for (const std::string& name : all_names) {
    fs::rename(Earlier(name), folder_ / name, ignored);
  }
}

void OutputFolder::Replace(const std::vector<OutputFile>& files,
                           const std::vector<std::string>& all_names) const {
  std::error_code ignored;
  try {
    for (const OutputFile& file : files) {
      WritePartial(file);
    }
  } catch (...) {
    for (const OutputFile& file : files) {
      if (file.content) {
        fs::remove(Partial(file.name), ignored);
      }
    }
    throw;
  }
  const std::lock_guard lock(placing_);
  for (const std::string& name : all_names) {
    fs::rename(folder_ / name, Earlier(name), ignored);
  }
  for (const OutputFile& file : files) {
    std::error_code error;
    fs::rename(Partial(file.name), folder_ / file.name, error);
    if (error) {
      TakeBack(files, all_names);
      throw InputError((folder_ / file.name).string() + ": cannot be written: " + error.message());
    }
  }
  for (const std::string& name : all_names) {
    fs::remove(Earlier(name), ignored);
  }
}

}  // namespace fovea::config
