// atlas.html: where runs began, how long they took and which failed, as one file that needs nothing else.
#pragma once

#include <filesystem>
#include <string>

#include "tools/fovea/atlas/figures.hpp"

namespace fovea::atlas {

class AtlasPage {
 public:
  // Reads the style of the reports in `folder`. std::runtime_error when it is not there.
  explicit AtlasPage(const std::filesystem::path& folder);

  // A page of its own around `main`, in the reports' style.
  [[nodiscard]] std::string Wrap(const std::string& title, const std::string& main) const;
  [[nodiscard]] std::string Make(const Figures& figures, const std::map<int, Row>& rows) const;

 private:
  std::string style_;
};

}  // namespace fovea::atlas
