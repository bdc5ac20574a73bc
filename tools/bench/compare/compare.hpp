// `fovea-bench compare OLD NEW`: the ratio of each figure that both have.
#pragma once

#include <string>

namespace fovea::bench {

struct CompareArguments {
  std::string old_file;  // as --json printed them
  std::string new_file;
  double most = 0.0;  // a figure whose new value is more than this times the old fails; 0: none does
};

int RunCompare(const CompareArguments& arguments);

}  // namespace fovea::bench
