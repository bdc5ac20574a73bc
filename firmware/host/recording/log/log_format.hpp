// SPDX-License-Identifier: Apache-2.0
// The version of a log's content: its topics, its messages, and the servo's lists of fields.
//
//   1  no format record
//   2  the format record; the key safety.face_tilt_max is called safety.disc_tilt_max
//   3  safety.link_clearance (before: safety.link_radius) and safety.sight_clearance count from the surface
//      of the arm's links; before, both counted from the lines between the joints
//
// The version rises when a program for the former version would misread the log. A new field at the end of
// its list, or a new topic, needs no new version.
#pragma once

#include <map>
#include <string>

namespace fovea::log {

inline constexpr int kLogFormat = 3;        // the format that is written
inline constexpr int kOldestLogFormat = 1;  // the oldest format that is read

inline constexpr const char* kFormatRecord = "format";  // the metadata record's name

// The format record of a log that `writer` (name and version) writes.
std::map<std::string, std::string> FormatEntries(const std::string& writer);

// "" if this program reads logs with that record; else the reason, with both versions and the writer.
std::string WhyUnreadable(const std::map<std::string, std::string>& format_entries);

}  // namespace fovea::log
