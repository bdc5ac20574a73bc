// SPDX-License-Identifier: Apache-2.0
// Shows an address in the user's browser.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::sim {

// The address has a token that other users must not see, and they see the command lines of all programs. So
// the browser gets a file that only its user may read, which leads to the address. The file lasts as long as
// the object.
class OpenedPage {
 public:
  // Prints a line when the browser cannot be started.
  explicit OpenedPage(const std::string& url);
  ~OpenedPage();
  OpenedPage(const OpenedPage&) = delete;
  OpenedPage& operator=(const OpenedPage&) = delete;

 private:
  std::filesystem::path file_;
};

}  // namespace fovea::sim
