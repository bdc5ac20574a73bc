// SPDX-License-Identifier: Apache-2.0
// Images from the command line: files, or folders with images.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea {

// The files, and the images of each folder in order of their names. InputError: a file does not exist, or a
// folder has no images.
std::vector<std::filesystem::path> ImageFiles(const std::vector<std::string>& paths);

// CV_8UC1 or CV_8UC3. InputError: not a readable image, another format, or too small.
cv::Mat ReadImage(const std::filesystem::path& path);

// Why no target can be visible: the image is black, saturated or without contrast. nullopt: none of these.
std::optional<std::string> WhyNothing(const cv::Mat& image);

}  // namespace fovea
