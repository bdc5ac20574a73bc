// Views of a target that are spread over the camera's way, however long that gets, in bounded space.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace fovea::estimate {

// `View` names its first step in kFirstStep; WayBetween(a, b) is how far the camera has gone from one view to
// the other, in the step's unit. What stands behind the first `count` views is never looked at.
template <class View, std::size_t kMostViews>
struct ViewsAlongTheWay {
  static constexpr int kMost = static_cast<int>(kMostViews);
  static_assert(kMost > 0 && kMost % 2 == 0);

  int count = 0;
  double step = View::kFirstStep;  // of the way from one view to the next; doubles when they are too many
  std::array<View, kMostViews> views;

  [[nodiscard]] std::span<const View> kept() const noexcept {
    return std::span<const View>(views).first(static_cast<std::size_t>(count));
  }

  // Takes `view` if the camera has gone a step since the last one. Where there is no room, every second view
  // goes. Real-time: yes.
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

  // The target has moved: what it showed before says nothing more. Real-time: yes.
  void Forget() noexcept {
    count = 0;
    step = View::kFirstStep;
  }
};

}  // namespace fovea::estimate
