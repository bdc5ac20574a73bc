// The version of what a log holds: its topics, its messages, and the servo's lists of fields.
//
//   1  no format record
//   2  the format record; the key safety.face_tilt_max is called safety.disc_tilt_max
//   3  safety.link_clearance and safety.sight_clearance count from the surface of the arm's links; before,
//   the first was
//      called safety.link_radius, and both counted from the lines between the joints
//
// It rises when a program that knows the former one would misread the log. A field at the end of its list,
// or another topic, needs no new version.
#pragma once

#include <map>
#include <string>

namespace fovea::log {

inline constexpr int kLogFormat = 3;        // written
inline constexpr int kOldestLogFormat = 1;  // read

inline constexpr const char* kFormatRecord = "format";  // the metadata record's name

// The record of a log that `writer` (name and version) writes.
std::map<std::string, std::string> FormatEntries(const std::string& writer);

// "" where this program reads logs of that record; else why it does not: both versions, and who wrote it.
std::string WhyUnreadable(const std::map<std::string, std::string>& format_entries);

}  // namespace fovea::log
