// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/calibration/board.hpp"

#include <algorithm>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

namespace fovea::calibration {
namespace {

constexpr std::size_t kFewestCorners = 8;  // of a ChArUco board: twice what a pose needs

cv::Ptr<cv::aruco::Dictionary> DictionaryOf(const Board& board) {
  const auto* name = std::find(kDictionaryNames.begin(), kDictionaryNames.end(), board.dictionary);
  if (name == kDictionaryNames.end()) {
    throw CalibrationError("unknown dictionary " + board.dictionary + ": 4x4_50 to 7x7_1000 are allowed");
  }
  return cv::aruco::getPredefinedDictionary(static_cast<int>(name - kDictionaryNames.begin()));
}

cv::Ptr<cv::aruco::CharucoBoard> MakeCharuco(const Board& board) {
  return cv::aruco::CharucoBoard::create(board.columns + 1, board.rows + 1, static_cast<float>(board.square),
                                         static_cast<float>(board.marker), DictionaryOf(board));
}

// Refines corners to a fraction of a pixel, in a window of `half_px` (2 to 11) to each side.
void Refine(const cv::Mat& gray, double half_px, std::vector<cv::Point2f>& corners) {
  const int half = std::clamp(static_cast<int>(half_px), 2, 11);
  cv::cornerSubPix(gray, corners, {half, half}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-4));
}

bool FindChessboard(const cv::Mat& gray, const Board& board, BoardView& view) {
  // FAST_CHECK: the full search of an image without a board takes many seconds.
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  if (!cv::findChessboardCorners(gray, {board.columns, board.rows}, view.corners, flags)) {
    return false;
  }
  view.ids.resize(view.corners.size());
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    view.ids[i] = static_cast<int>(i);
  }
  // The window must stay within the squares around a corner.
  Refine(gray, 0.35 * cv::norm(view.corners[0] - view.corners[1]), view.corners);
  return true;
}

// The shortest distance between two visible neighbour corners [px]; 0 if there is no such pair.
double SquarePx(const Board& board, const BoardView& view) {
  double least = 0.0;
  for (std::size_t i = 0; i + 1 < view.ids.size(); ++i) {
    for (std::size_t k = i + 1; k < view.ids.size(); ++k) {
      const bool same_row = view.ids[i] / board.columns == view.ids[k] / board.columns;
      if ((same_row && view.ids[k] == view.ids[i] + 1) || view.ids[k] == view.ids[i] + board.columns) {
        const double apart = cv::norm(view.corners[i] - view.corners[k]);
        least = least == 0.0 ? apart : std::min(least, apart);
      }
    }
  }
  return least;
}

bool FindCharuco(const cv::Mat& gray, const Board& board, BoardView& view) {
  const cv::Ptr<cv::aruco::CharucoBoard> charuco = MakeCharuco(board);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(gray, charuco->dictionary, markers, marker_ids);
  if (marker_ids.empty()) {
    return false;
  }
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, gray, charuco, view.corners, view.ids);
  std::set<int> rows;
  std::set<int> columns;
  for (const int id : view.ids) {
    rows.insert(id / board.columns);
    columns.insert(id % board.columns);
  }
  if (view.ids.size() < kFewestCorners || rows.size() < 2 || columns.size() < 2) {
    return false;
  }
  // OpenCV's interpolation stops at 0.1 px. The window excludes the markers: their corners would add a bias.
  const double margin = 0.5 * (board.square - board.marker) / board.square;
  Refine(gray, 0.9 * margin * SquarePx(board, view), view.corners);
  return true;
}

}  // namespace

void CheckBoard(const Board& board) {
  if (!board.HasMarkers()) {
    return;
  }
  if (board.marker >= 0.95 * board.square) {
    throw CalibrationError("a marker's side must be below 0.95 of a square's side");
  }
  const int needed = (board.columns + 1) * (board.rows + 1) / 2;
  const int there = DictionaryOf(board)->bytesList.rows;
  if (needed > there) {
    throw CalibrationError("the board has " + std::to_string(needed) + " markers, but the dictionary " +
                           board.dictionary + " has only " + std::to_string(there));
  }
}

cv::Point3f CornerOf(const Board& board, int id) {
  const int column = id % board.columns;
  const int row = id / board.columns;
  return {static_cast<float>(column * board.square), static_cast<float>(row * board.square), 0.0F};
}

bool FindBoard(const cv::Mat& image, const Board& board, BoardView& view) {
  cv::Mat gray = image;
  if (image.channels() == 3) {
    cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  }
  view.corners.clear();
  view.ids.clear();
  return board.HasMarkers() ? FindCharuco(gray, board, view) : FindChessboard(gray, board, view);
}

cv::Mat DrawBoard(const Board& board, int square_px) {
  const cv::Size size((board.columns + 1) * square_px, (board.rows + 1) * square_px);
  cv::Mat image;
  if (board.HasMarkers()) {
    MakeCharuco(board)->draw(size, image);
    return image;
  }
  image = cv::Mat(size, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = row % 2; column <= board.columns; column += 2) {
      image(cv::Rect(column * square_px, row * square_px, square_px, square_px)).setTo(0);
    }
  }
  return image;
}

}  // namespace fovea::calibration
