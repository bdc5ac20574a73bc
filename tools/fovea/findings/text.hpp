// SPDX-License-Identifier: Apache-2.0
// A study of findings as a table, JSON and the Markdown page sim/FINDINGS.md.
#pragma once

#include <string>

#include "tools/fovea/findings/study.hpp"

namespace fovea::findings {

// The result in one sentence.
std::string Verdict(const Study& study);
std::string ToTable(const Study& study);
std::string ToJson(const Study& study);
std::string ToMarkdown(const Study& study);

}  // namespace fovea::findings
