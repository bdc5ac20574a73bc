// SPDX-License-Identifier: Apache-2.0
// atlas.html of a fault matrix: totals, and a table for each mode of run.
#pragma once

#include <string>

#include "tools/fovea/faults/matrix.hpp"

namespace fovea::matrix {

// The page's main part, for AtlasPage::Wrap.
std::string ToHtml(const Matrix& matrix);

}  // namespace fovea::matrix
