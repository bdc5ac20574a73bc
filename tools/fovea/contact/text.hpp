// SPDX-License-Identifier: Apache-2.0
// A contact study as a table, JSON and the Markdown page sim/CONTACT.md.
#pragma once

#include <string>

#include "tools/fovea/contact/study.hpp"

namespace fovea::contact {

// "12 of 12, 14 ms (at most 25), 3 by others": stops, the detector's time, stops by other guards.
std::string InWords(const Detection& detection);
// "0 in 8.1 min (less than 22 per hour)"
std::string InWords(const FalseAlarms& alarms);

// The result with the default limits in one sentence.
std::string Verdict(const Study& study);
std::string ToTable(const Study& study);
std::string ToJson(const Study& study);
std::string ToMarkdown(const Study& study);

}  // namespace fovea::contact
