// SPDX-License-Identifier: Apache-2.0
// Keeps views of a target spread over the camera's path of any length, in bounded memory.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace fovea::estimate {

// View::kFirstStep is the first step. WayBetween(a, b) is the camera's travel between two views, in the
// step's unit. Only the first `count` views are used.
template <class View, std::size_t kMostViews>
struct ViewsAlongTheWay {
  static constexpr int kMost = static_cast<int>(kMostViews);
  static_assert(kMost > 0 && kMost % 2 == 0);

  int count = 0;
  double step = View::kFirstStep;  // travel between two kept views; doubles when the array is full
  std::array<View, kMostViews> views;

  [[nodiscard]] std::span<const View> kept() const noexcept {
    return std::span<const View>(views).first(static_cast<std::size_t>(count));
  }

  // Keeps `view` if the camera has moved by a step since the last one. If there is no room, drops every
  // second view. Real-time: yes.
  void Keep(const View& view) noexcept {
    if (count > 0 && !(WayBetween(views[static_cast<std::size_t>(count - 1)], view) >= step)) {
      return;
    }
    if (count == kMost) {
      for (std::size_t i = 1; 2 * i < kMostViews; ++i) {
        views[i] = views[2 * i];
      }
      count = kMost / 2;
      step *= 2.0;
    }
    views[static_cast<std::size_t>(count++)] = view;
  }

  // Drops all views, because the target has moved. Real-time: yes.
  void Forget() noexcept {
    count = 0;
    step = View::kFirstStep;
  }
};

}  // namespace fovea::estimate
