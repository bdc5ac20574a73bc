// SPDX-License-Identifier: Apache-2.0
// Rolling shutter, for the renderer: the rows of a sensor are exposed one after the other.
#pragma once

#include <array>

#include "sim/render/exposure.hpp"

namespace fovea::sim {

// How a point (x, y) of the ideal normalised image gets its row: v = f_v y' + c_v, with y' by Brown's lens.
struct SensorRows {
  double f_v_px = 0.0;
  double c_v_px = 0.0;
  std::array<double, 5> lens{};  // k1, k2, p1, p2, k3
};

// Neighbouring rows, with the moments at which they are exposed. Within a band, all moves uniformly.
struct RowBand {
  Moment first;  // at the upper edge of the first row
  Moment middle;
  Moment last;              // at the lower edge of the last row
  double rows = 0.0;        // of the sensor, from `first` to `last`
  double middle_row = 0.0;  // of the sensor
  int begin_px = 0;         // drawn rows of the picture: from this one
  int end_px = 0;           // to the one before this
};

}  // namespace fovea::sim
