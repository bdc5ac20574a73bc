// SPDX-License-Identifier: Apache-2.0
// atlas.html: maps of the starts, settling times and failures, in one self-contained file.
#pragma once

#include <filesystem>
#include <string>

#include "tools/fovea/atlas/figures.hpp"

namespace fovea::atlas {

class AtlasPage {
 public:
  // Reads the style of the reports from `folder`. std::runtime_error when it is missing.
  explicit AtlasPage(const std::filesystem::path& folder);

  // A complete page around `main`, in the reports' style.
  [[nodiscard]] std::string Wrap(const std::string& title, const std::string& main) const;
  [[nodiscard]] std::string Make(const Figures& figures, const std::map<int, Row>& rows) const;

 private:
  std::string style_;
};

}  // namespace fovea::atlas
