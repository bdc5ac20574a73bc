// SPDX-License-Identifier: Apache-2.0
// Table B1 of the course exercises for all targets, corrected: parameters, size, rank and condition from the
// matrices, detection difficulty from pictures.
#pragma once

namespace fovea {

// Prints the table, which takes some seconds; returns the program's exit code.
int PrintFeatureTables(bool json);

}  // namespace fovea
