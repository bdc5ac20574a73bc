// Boards to calibrate with: a chessboard, which must be seen whole, or a ChArUco board, of which a part is
// enough, since markers in its white squares say which corner is which. Not for the camera's rate.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace fovea::calibration {

// Why input will not do, in one line.
class CalibrationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// ArUco's dictionaries: bits of a marker, and how many markers there are.
inline constexpr std::array<const char*, 16> kDictionaryNames{
    "4x4_50", "4x4_100", "4x4_250", "4x4_1000", "5x5_50", "5x5_100", "5x5_250", "5x5_1000",
    "6x6_50", "6x6_100", "6x6_250", "6x6_1000", "7x7_50", "7x7_100", "7x7_250", "7x7_1000"};

struct Board {
  int columns = 9;  // inner corners: squares less one
  int rows = 6;
  double square = 0.025;               // its side [m]
  double marker = 0.0;                 // side of a ChArUco board's markers [m]; 0: a chessboard
  std::string dictionary = "5x5_100";  // of the markers

  [[nodiscard]] bool HasMarkers() const { return marker > 0.0; }
};

// What was seen of a board in one image.
struct BoardView {
  std::string name;
  std::vector<cv::Point2f> corners;  // [px]
  std::vector<int> ids;              // which inner corner each is, counted row by row
};

// CalibrationError: markers that do not fit into the squares, or more than the dictionary has.
void CheckBoard(const Board& board);

// The inner corner of that number, on the board: x along columns, y along rows, from the first [m].
cv::Point3f CornerOf(const Board& board, int id);

// Finds the board's inner corners. False when not all of a chessboard's are there, or of a ChArUco board's
// too few, or all in one line. `image` is CV_8UC1 or CV_8UC3.
bool FindBoard(const cv::Mat& image, const Board& board, BoardView& view);

// The board as it is printed, without a margin, black square at the top left: CV_8UC1.
cv::Mat DrawBoard(const Board& board, int square_px);

}  // namespace fovea::calibration
