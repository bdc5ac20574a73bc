// SPDX-License-Identifier: Apache-2.0
// `fovea-bench compare OLD NEW`: the ratio of each figure that both files have.
#pragma once

#include <string>

namespace fovea::bench {

struct CompareArguments {
  std::string old_file;  // output of --json
  std::string new_file;
  double most = 0.0;  // a figure fails when its new value exceeds this multiple of the old; 0: no limit
};

int RunCompare(const CompareArguments& arguments);

}  // namespace fovea::bench
