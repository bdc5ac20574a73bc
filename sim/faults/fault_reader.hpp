// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

// A visitor of the lists of faults that does nothing. Derived classes replace the functions that they need.
class FaultReader {
 public:
  void Window(const FaultField& /*field*/, const TimeWindow& /*window*/,
              const char* /*not_served*/ = nullptr) {}
  void Number(const FaultField& /*field*/, const double& /*value*/, double /*min*/, double /*max*/) {}
  template <class T>
  void Scaled(const FaultField& /*field*/, const T& /*value*/, double /*unit*/, double /*min*/,
              double /*max*/) {}
  void Flag(const FaultField& /*field*/, const bool& /*value*/) {}
  void Joint(const FaultField& /*field*/, const int& /*value*/, const TimeWindow& /*window*/, int /*least*/) {
  }
  template <class Values>
  void List(const FaultField& /*field*/, const Values& /*values*/, std::size_t /*most*/, double /*min*/,
            double /*max*/) {}
  template <class... Doubles>
  void Numbers(const FaultField& /*field*/, double /*min*/, double /*max*/, const Doubles&... /*values*/) {}
  void Size(const FaultField& /*field*/, double /*value*/) {}
};

}  // namespace fovea::sim
