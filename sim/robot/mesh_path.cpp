// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/mesh_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace fovea::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPackage = "package://";
constexpr const char* kFile = "file://";

bool StartsWith(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool IsFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// The entries of a colon-separated list in the environment.
std::vector<fs::path> Entries(const char* variable) {
  std::vector<fs::path> entries;
  const char* list = std::getenv(variable);
  std::istringstream stream(list == nullptr ? "" : list);
  for (std::string entry; std::getline(stream, entry, ':');) {
    if (!entry.empty()) {
      entries.emplace_back(entry);
    }
  }
  return entries;
}

// Candidate folders of the package, the nearest first. Those above the URDF must lie inside `root`, if given.
std::vector<fs::path> PackageFolders(const fs::path& urdf, const std::string& name, const fs::path& root) {
  std::vector<fs::path> folders;
  const fs::path start = fs::absolute(urdf).lexically_normal().parent_path();
  for (fs::path above = start;; above = above.parent_path()) {
    if (above.filename() == name) {
      folders.push_back(above);
    }
    folders.push_back(above / name);
    if (above == above.parent_path()) {
      break;
    }
  }
  if (!root.empty()) {
    std::erase_if(folders, [&root](const fs::path& folder) { return !LiesIn(root, folder); });
  }
  for (const fs::path& entry : Entries("ROS_PACKAGE_PATH")) {
    folders.push_back(entry / name);
  }
  for (const fs::path& entry : Entries("AMENT_PREFIX_PATH")) {
    folders.push_back(entry / "share" / name);
  }
  return folders;
}

fs::path FindInPackage(const fs::path& urdf, const std::string& name, const std::string& rest,
                       const fs::path& root) {
  std::string there_is;
  for (const fs::path& folder : PackageFolders(urdf, name, root)) {
    if (IsFile(folder / rest)) {
      return folder / rest;
    }
    if (there_is.empty() && IsFolder(folder)) {
      there_is = (folder / rest).string();
    }
  }
  if (!there_is.empty()) {
    throw std::runtime_error(fmt::format("no such file: {}", there_is));
  }
  throw std::runtime_error(fmt::format(
      "no folder of package \"{}\": searched above {}, in ROS_PACKAGE_PATH and in AMENT_PREFIX_PATH/share",
      name, fs::absolute(urdf).lexically_normal().parent_path().string()));
}

fs::path FindAnywhere(const fs::path& urdf, const std::string& filename, const fs::path& root) {
  if (StartsWith(filename, kPackage)) {
    const std::string path = filename.substr(std::string(kPackage).size());
    const auto slash = path.find('/');
    if (slash == std::string::npos || slash == 0 || slash + 1 == path.size()) {
      throw std::runtime_error("a package URL has the form package://name/path");
    }
    return FindInPackage(urdf, path.substr(0, slash), path.substr(slash + 1), root);
  }
  fs::path file = filename;
  if (StartsWith(filename, kFile)) {
    file = filename.substr(std::string(kFile).size());
    if (!file.is_absolute()) {
      throw std::runtime_error("a file URL has the form file:///absolute/path");
    }
  } else if (filename.find("://") != std::string::npos) {
    throw std::runtime_error("only package:// and file:// URLs, and paths, are supported");
  }
  if (file.is_relative()) {
    file = urdf.parent_path() / file;
  }
  if (!IsFile(file)) {
    throw std::runtime_error(fmt::format("no such file: {}", fs::absolute(file).lexically_normal().string()));
  }
  return file;
}

// Whether the path of `file` lies in one of the user's packages. Links inside a package may lead anywhere; a
// ".." in the path may not leave the package.
bool IsUsersPackage(const fs::path& file) {
  const fs::path plain = fs::absolute(file).lexically_normal();
  for (const char* variable : {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"}) {
    for (const fs::path& entry : Entries(variable)) {
      const fs::path top = fs::absolute(entry / ".").lexically_normal().parent_path();
      if (std::mismatch(top.begin(), top.end(), plain.begin(), plain.end()).first == top.end()) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool LiesIn(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path top = fs::canonical(folder.empty() ? "." : folder, error);
  const fs::path place = error ? fs::path() : fs::weakly_canonical(fs::absolute(file), error);
  return !error && std::mismatch(top.begin(), top.end(), place.begin(), place.end()).first == top.end();
}

fs::path FindMeshFile(const fs::path& urdf, const std::string& filename, const fs::path& root) {
  const fs::path file = FindAnywhere(urdf, filename, root);
  if (!root.empty() && !LiesIn(root, file) && !(StartsWith(filename, kPackage) && IsUsersPackage(file))) {
    throw std::runtime_error(fmt::format("it lies outside {}, the folder of the file that names it",
                                         fs::absolute(root).lexically_normal().string()));
  }
  return file;
}

}  // namespace fovea::sim
