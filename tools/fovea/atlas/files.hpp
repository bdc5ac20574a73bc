// SPDX-License-Identifier: Apache-2.0
// Reads and writes small files of an atlas.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::atlas {

// The content of `file`; "" when it cannot be read.
std::string Content(const std::filesystem::path& file);
// Why the simulator ended, from what it `said`: its last line with its name, which follows any progress
// lines; without that name and without --set, which the caller did not write.
std::string ReasonOf(const std::string& said);
// InputError: the file cannot be written. Keeps what is in it; to be asked before long work.
void CheckWritable(const std::filesystem::path& file);
// InputError: the file cannot be written.
void WriteFile(const std::filesystem::path& file, const std::string& content);

}  // namespace fovea::atlas
