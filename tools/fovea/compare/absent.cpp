// SPDX-License-Identifier: Apache-2.0
// A build without the simulator has no command compare.
#include "tools/fovea/compare/compare.hpp"

#include "firmware/host/config/program.hpp"

namespace fovea {

const CLI::App* AddCompare(CLI::App&, CompareArguments&) { return nullptr; }
int Compare(const CompareArguments&) { return config::kBadInput; }

}  // namespace fovea
