// From a picture to a target.
#pragma once

#include "firmware/vision/detect/target_detector.hpp"  // IWYU pragma: export
