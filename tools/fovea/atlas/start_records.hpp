// SPDX-License-Identifier: Apache-2.0
// Reads the file of --starts as text: the numbers of each start, by column, before anyone asks what they
// mean.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fovea::atlas {

// The numbers of one start, by column.
struct StartRecord {
  int line = 0;  // on which it begins
  std::map<std::string, double> values;
};

// The text of `file`, without byte order mark and with a line feed at each line's end. InputError: it is not
// a regular file, too large, not UTF-8, or cannot be read.
std::string StartsText(const std::filesystem::path& file);

// The records of `text`, the content of `file`: JSON if it begins with a bracket, else CSV. InputError, with
// file, line, column and what is allowed: it is neither, a value is no finite number, a column occurs twice,
// or there is no start.
std::vector<StartRecord> ReadStartRecords(const std::filesystem::path& file, const std::string& text);

// "file:line".
std::string At(const std::filesystem::path& file, int line);
// As much of `text` as an error in one line quotes.
std::string Shortened(const std::string& text);

}  // namespace fovea::atlas
