#include "sim/app/output_folder.hpp"

#include <unistd.h>

#include <fstream>

#include "fovea/config/input_error.hpp"

namespace fovea::sim {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(const fs::path& folder) : folder_(folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_)) {
    throw config::InputError("--out " + folder_.string() + ": the folder cannot be made: " +
                             (error ? error.message() : "something else has that name"));
  }
  if (access(folder_.c_str(), W_OK | X_OK) != 0) {
    throw config::InputError("--out " + folder_.string() + ": the folder cannot be written to");
  }
}

void OutputFolder::Write(const std::string& name, const std::string& content) const {
  const fs::path partial = folder_ / ("." + name + ".partial");
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  std::error_code error;
  if (file) {
    fs::rename(partial, folder_ / name, error);
  }
  if (!file || error) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw config::InputError((folder_ / name).string() + ": cannot be written" +
                             (error ? ": " + error.message() : std::string(" (is the disk full?)")));
  }
}

}  // namespace fovea::sim
