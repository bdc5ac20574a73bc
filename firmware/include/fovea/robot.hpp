// Arms from their files.
#pragma once

#include "firmware/host/robots/robot.hpp"  // IWYU pragma: export
