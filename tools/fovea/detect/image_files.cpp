// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/detect/image_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <opencv2/imgcodecs.hpp>

#include "firmware/host/config/input_error.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

constexpr int kSmallestPx = 32;

bool IsImage(const fs::path& path) {
  constexpr std::array kEndings{".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm", ".tif", ".tiff", ".webp"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace

std::vector<fs::path> ImageFiles(const std::vector<std::string>& paths) {
  std::vector<fs::path> files;
  for (const std::string& name : paths) {
    const fs::path path(name);
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) {
      if (!fs::exists(path, ignored)) {
        throw config::InputError(name + ": no such file");
      }
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file() && IsImage(entry.path())) {
        files.push_back(entry.path());
      }
    }
    if (files.size() == before) {
      throw config::InputError(name + ": no images in this folder (png, jpg, bmp, pgm, ppm, tif, webp)");
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  return files;
}

cv::Mat ReadImage(const fs::path& path) {
  cv::Mat image;
  try {
    image = cv::imread(path.string(), cv::IMREAD_ANYCOLOR);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) {
    throw config::InputError(path.string() + ": not an image that can be read");
  }
  if (image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3)) {
    throw config::InputError(fmt::format("{}: {} channels of this depth; must be 8-bit gray or colour",
                                         path.string(), image.channels()));
  }
  if (std::min(image.cols, image.rows) < kSmallestPx) {
    throw config::InputError(fmt::format("{}: {} x {} px; width and height must be {} or more", path.string(),
                                         image.cols, image.rows, kSmallestPx));
  }
  return image;
}

std::optional<std::string> WhyNothing(const cv::Mat& image) {
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(image.reshape(1), &low, &high);
  if (high < 8.0) {
    return "the image is black";
  }
  if (low > 247.0) {
    return "the image is saturated";
  }
  return high - low < 6.0 ? std::make_optional("the image has no contrast") : std::nullopt;
}

}  // namespace fovea
