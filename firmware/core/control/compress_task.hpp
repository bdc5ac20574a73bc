// SPDX-License-Identifier: Apache-2.0
// Reduces a task to six rows, the hand's degrees of freedom. With L = Q R, the least-squares solution of L V
// = v is that of R V = Q^T v. A task of six rows costs the law a third of one of eight.
#pragma once

#include "firmware/core/features/feature_state.hpp"

namespace fovea::control {

// Replaces `L` [dim x 6] and `v` [dim] by R and the first six entries of Q^T v; up to six rows stay as they
// are. Modified Gram-Schmidt with v as one more column is as accurate as reflections (Bjorck, Solving linear
// least squares problems by Gram-Schmidt orthogonalization, 1967). It takes a third of their time, because no
// column waits for a root. Real-time: yes.
void CompressTask(features::InteractionMatrix& L, features::FeatureVector& v) noexcept;

}  // namespace fovea::control
