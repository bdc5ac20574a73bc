// The source's tables B1 of all targets beside each other, with its corrections: parameters, size, rank and
// condition from the matrices, extraction difficulty from pictures.
#pragma once

namespace fovea {

// Prints them, some seconds long; returns the program's exit code.
int PrintFeatureTables(bool json);

}  // namespace fovea
