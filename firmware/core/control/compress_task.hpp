// A task of more rows than the hand has degrees of freedom, in as many rows as it has: the least-squares
// solution of L V = v is that of R V = Q^T v with L = Q R, and a task of six rows costs the law a third of
// one of eight.
#pragma once

#include "firmware/core/features/feature_state.hpp"

namespace fovea::control {

// Leaves `L` [dim x 6] and `v` [dim] with at most six rows: R and the head of Q^T v, by the modified method
// of Gram and Schmidt, which takes v along as one more column and is then as accurate as reflections are
// (Bjorck, Solving linear least squares problems by Gram-Schmidt orthogonalization, 1967), with a third of
// their time, since no column waits for a root. Fewer rows stay as they are. Real-time: yes.
void CompressTask(features::InteractionMatrix& L, features::FeatureVector& v) noexcept;

}  // namespace fovea::control
