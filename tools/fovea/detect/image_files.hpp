// Images that a person names: files, or folders of them.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea {

// The files, and the images in each folder by name. InputError: no such file, a folder without images.
std::vector<std::filesystem::path> ImageFiles(const std::vector<std::string>& paths);

// CV_8UC1 or CV_8UC3. InputError: no image, or one too small to look at.
cv::Mat ReadImage(const std::filesystem::path& path);

// Why a picture shows nothing, where that is plain to see.
std::optional<std::string> WhyNothing(const cv::Mat& image);

}  // namespace fovea
