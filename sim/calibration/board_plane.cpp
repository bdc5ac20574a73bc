// SPDX-License-Identifier: Apache-2.0
#include "sim/calibration/board_plane.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"

namespace fovea::sim {
namespace {

constexpr int kTexturePx = 2048;
constexpr int kFewestPx = 40;      // per square: each bit of a marker needs several texels
constexpr double kLargest = 0.60;  // longest side of the paper that fits on the bench [m]
constexpr double kPaper = 0.003;   // height of the paper above the table [m]
constexpr double kBlack = 0.08;    // reflectance of black paint
constexpr double kWhite = 0.78;    // and of white paper

}  // namespace

BoardPlane MakeBoardPlane(const calibration::Board& board, const Eigen::Vector3d& middle_B) {
  // A whole and even number of texels per square, with a square of paper on each side.
  const int square_px = kTexturePx / (std::max(board.columns, board.rows) + 3) / 2 * 2;
  const double side = board.square * kTexturePx / std::max(square_px, 1);
  if (square_px < kFewestPx || side > kLargest) {
    throw config::InputError(fmt::format(
        "--board {}x{} --square {} is not allowed: the board with its paper may be at most {} m wide, with "
        "at most {} squares per side",
        board.columns, board.rows, board.square, kLargest, kTexturePx / kFewestPx - 2));
  }
  const cv::Mat drawn = calibration::DrawBoard(board, square_px);
  BoardPlane made;
  made.middle_B = middle_B + Eigen::Vector3d(0.0, 0.0, kPaper);
  made.plane.centre_B = made.middle_B.cast<float>();
  made.plane.size.setConstant(static_cast<float>(side));
  made.plane.tile = made.plane.size;
  Texture& texture = made.plane.texture;
  texture.width_px = texture.height_px = kTexturePx;
  texture.rgba.assign(std::size_t{4} * kTexturePx * kTexturePx, static_cast<std::uint8_t>(255.0 * kWhite));
  const int left = (kTexturePx - drawn.cols) / 2;
  const int top = (kTexturePx - drawn.rows) / 2;
  for (int row = 0; row < drawn.rows; ++row) {
    for (int column = 0; column < drawn.cols; ++column) {
      const double share = drawn.at<std::uint8_t>(row, column) / 255.0;
      // The texture's rows run along +y of B, the board's rows along -y.
      const auto at = 4 * (static_cast<std::size_t>(kTexturePx - 1 - top - row) * kTexturePx +
                           static_cast<std::size_t>(left + column));
      std::fill_n(texture.rgba.begin() + static_cast<std::ptrdiff_t>(at), 3,
                  static_cast<std::uint8_t>(255.0 * (kBlack + share * (kWhite - kBlack))));
    }
  }
  const double half_x = 0.5 * (board.columns + 1) * board.square;
  const double half_y = 0.5 * (board.rows + 1) * board.square;
  made.outline_B = {made.middle_B + Eigen::Vector3d(-half_x, half_y, 0.0),
                    made.middle_B + Eigen::Vector3d(half_x, half_y, 0.0),
                    made.middle_B + Eigen::Vector3d(half_x, -half_y, 0.0),
                    made.middle_B + Eigen::Vector3d(-half_x, -half_y, 0.0)};
  return made;
}

}  // namespace fovea::sim
