// SPDX-License-Identifier: Apache-2.0
#include "sim/app/opened_page.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cstdlib>

#include <array>
#include <string_view>
#include <thread>

#include "firmware/host/config/program.hpp"

namespace fovea::sim {
namespace {

constexpr std::string_view kSuffix = ".html";

// "" when there is no place for it.
std::filesystem::path WriteLeadingTo(const std::string& url) {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "fovea-page-XXXXXX").string();
  name += kSuffix;
  const int file = error ? -1 : mkstemps(name.data(), static_cast<int>(kSuffix.size()));  // mode 0600
  if (file < 0) {
    return {};
  }
  const std::string page =
      fmt::format("<!doctype html><meta http-equiv=\"refresh\" content=\"0;url={}\">\n", url);
  const bool is_written = write(file, page.data(), page.size()) == static_cast<ssize_t>(page.size());
  close(file);
  if (!is_written) {
    std::filesystem::remove(name, error);
    return {};
  }
  return name;
}

}  // namespace

OpenedPage::OpenedPage(const std::string& url) : file_(WriteLeadingTo(url)) {
  if (file_.empty()) {
    config::PrintError("fovea-sim", "no file can be written for the browser; open the address by hand");
    return;
  }
  std::string program = "xdg-open";
  std::string path = file_.string();
  std::array<char*, 3> command{program.data(), path.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, command.data(), environ) != 0) {
    config::PrintError("fovea-sim", "xdg-open is not installed; open the address by hand");
    return;
  }
  std::thread([child] { waitpid(child, nullptr, 0); }).detach();  // it may be the browser, which outlives us
}

OpenedPage::~OpenedPage() {
  if (!file_.empty()) {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
}

}  // namespace fovea::sim
