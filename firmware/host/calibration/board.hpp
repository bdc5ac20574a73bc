// SPDX-License-Identifier: Apache-2.0
// Calibration boards: a chessboard, which must be wholly visible, or a ChArUco board, of which a part is
// enough: the markers in its white squares identify the corners. Too slow for the camera's rate.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace fovea::calibration {

// Unusable input. what() gives the reason in one line.
class CalibrationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// ArUco's dictionaries in OpenCV's order: a marker's bits, then the number of markers.
inline constexpr std::array<const char*, 16> kDictionaryNames{
    "4x4_50", "4x4_100", "4x4_250", "4x4_1000", "5x5_50", "5x5_100", "5x5_250", "5x5_1000",
    "6x6_50", "6x6_100", "6x6_250", "6x6_1000", "7x7_50", "7x7_100", "7x7_250", "7x7_1000"};

struct Board {
  int columns = 9;  // inner corners: squares less one
  int rows = 6;
  double square = 0.025;               // side of a square [m]
  double marker = 0.0;                 // side of a ChArUco board's markers [m]; 0: a chessboard
  std::string dictionary = "5x5_100";  // of the markers

  [[nodiscard]] bool HasMarkers() const { return marker > 0.0; }
};

// The corners of a board that are visible in one image.
struct BoardView {
  std::string name;
  std::vector<cv::Point2f> corners;  // [px]
  std::vector<int> ids;              // number of each inner corner, counted row by row
};

// CalibrationError: markers that do not fit into the squares, or a dictionary that is unknown or too small.
void CheckBoard(const Board& board);

// Position of inner corner `id` on the board [m]: x grows with the column, y with the row; corner 0 is at 0.
cv::Point3f CornerOf(const Board& board, int id);

// Finds the board's inner corners. False when a chessboard is not wholly visible, or when a ChArUco board
// shows too few corners or only one row or column of them. `image` is CV_8UC1 or CV_8UC3.
bool FindBoard(const cv::Mat& image, const Board& board, BoardView& view);

// Draws the board for printing, without a margin, black square at the top left: CV_8UC1.
cv::Mat DrawBoard(const Board& board, int square_px);

}  // namespace fovea::calibration
