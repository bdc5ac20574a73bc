// Who watches a tick's stages from outside.
#pragma once

#include "firmware/core/task/stage_probe.hpp"  // IWYU pragma: export
