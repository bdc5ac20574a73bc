// SPDX-License-Identifier: Apache-2.0
// A heat map of runs over two of their quantities, as SVG.
#pragma once

#include <string>
#include <vector>

namespace fovea::atlas {

struct MapPoint {
  double x = 0.0;
  double y = 0.0;
  double heat = 0.0;  // valid if the run did not fail
  bool failed = false;
  int run = 0;
};

struct MapAxes {
  std::string x_name;
  std::string y_name;
  double x_min = 0.0, x_max = 1.0;
  double y_min = 0.0, y_max = 1.0;
  double cell = 0.1;    // side of a cell, in the axes' unit
  bool y_down = false;  // y grows downwards, as in a picture
};

// The range of heat that the colours cover.
struct HeatScale {
  double least = 0.0;
  double most = 1.0;
};

// A cell's colour shows its median heat, its number the count of runs in it. A cross marks a failed run, with
// the run's number.
std::string HeatMap(const std::vector<MapPoint>& points, const MapAxes& axes, const HeatScale& scale);

// A step of 1, 2 or 5 times a power of ten that gives about six labels on an axis of length `range`.
double TickStep(double range);

// The colours with their values.
std::string HeatLegend(const HeatScale& scale, const std::string& name);

}  // namespace fovea::atlas
