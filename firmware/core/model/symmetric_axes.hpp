// SPDX-License-Identifier: Apache-2.0
// Eigenvectors (axes) of a small symmetric matrix, A = U diag(a) U^T, by Jacobi rotations in bounded time.
//
// A sweep rotates each pair of axes once, in rounds of disjoint pairs (as in a chess tournament), so that the
// rotations of a round do not wait for each other. An angle takes one division and no root. It is accurate to
// a tenth if it is large, and to third order if it is small. This costs one more sweep at the start; the last
// ones converge as with exact angles. Each rotation is orthogonal to the last bit, whatever its angle. U is
// kept as its rotations, which is enough for a function of A times a vector:
//
//   f(A) x = U diag(f(a)) U^T x
//
// The error of each a is the rounding error of the largest. (Golub and Van Loan, Matrix Computations, 2013,
// section 8.5; for small singular values to their own last bits see row_svd.hpp.)
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "firmware/core/model/ldlt.hpp"

namespace fovea::model {

class SymmetricAxes {
 public:
  static constexpr int kMaxSweeps = 12;  // a matrix of six rows takes four to six, eight to nine at most

  // Diagonalises `A` [kSize x kSize], of which only the diagonal and the part right of it are read. The
  // diagonal becomes a, unsorted. kSize is even, 8 at most. Non-finite input gives non-finite output.
  // Real-time: yes.
  template <std::size_t kSize>
  void Diagonalise(model::Square8& A) noexcept {
    double trace = 0.0;
    for (std::size_t i = 0; i < kSize; ++i) {
      trace += std::fabs(A[i][i]);
    }
    const double nothing2 = kRounding * kRounding * trace * trace;
    for (sweeps_ = 0; sweeps_ < kMaxSweeps && OffDiagonal2<kSize>(A) > nothing2; ++sweeps_) {
      Sweep<kSize>(A, turns_[static_cast<std::size_t>(sweeps_)], std::make_index_sequence<kSize - 1>());
    }
  }

  // x = U^T x: from the axes of A to its own. Real-time: yes.
  template <std::size_t kSize>
  void ToAxes(std::array<double, 8>& x) const noexcept {
    for (std::size_t sweep = 0; sweep < static_cast<std::size_t>(sweeps_); ++sweep) {
      for (std::size_t turn = 0; turn < kPairs<kSize>.size(); ++turn) {
        const auto [i, j] = kPairs<kSize>[turn];
        const Turn& by = turns_[sweep][turn];
        const double x_i = x[i];
        x[i] = by.c * x_i - by.s * x[j];
        x[j] = by.s * x_i + by.c * x[j];
      }
    }
  }

  // x = U x. Real-time: yes.
  template <std::size_t kSize>
  void FromAxes(std::array<double, 8>& x) const noexcept {
    for (auto sweep = static_cast<std::size_t>(sweeps_); sweep-- > 0;) {
      for (std::size_t turn = kPairs<kSize>.size(); turn-- > 0;) {
        const auto [i, j] = kPairs<kSize>[turn];
        const Turn& by = turns_[sweep][turn];
        const double x_i = x[i];
        x[i] = by.c * x_i + by.s * x[j];
        x[j] = by.c * x[j] - by.s * x_i;
      }
    }
  }

  [[nodiscard]] int sweeps() const noexcept { return sweeps_; }

 private:
  struct Turn {
    double c, s;
  };
  struct Pair {
    std::size_t i, j;  // i < j
  };

  static constexpr double kRounding = 1e-15;  // of the trace: a smaller off-diagonal part counts as zero
  static constexpr std::size_t kMaxTurns = 28;
  using Turns = std::array<Turn, kMaxTurns>;  // of a sweep

  // The tournament: the last player stays, the others go round.
  template <std::size_t kSize>
  static constexpr auto Tournament() noexcept {
    static_assert(kSize % 2 == 0 && kSize <= 8);
    constexpr std::size_t kRounds = kSize - 1;
    std::array<Pair, kRounds * kSize / 2> pairs{};
    for (std::size_t round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < kSize / 2; ++k) {
        const std::size_t one = (round + k) % kRounds;
        const std::size_t other = k == 0 ? kRounds : (round + kRounds - k) % kRounds;
        pairs[round * kSize / 2 + k] = one < other ? Pair{one, other} : Pair{other, one};
      }
    }
    return pairs;
  }
  template <std::size_t kSize>
  static constexpr auto kPairs = Tournament<kSize>();

  template <std::size_t kSize>
  static double OffDiagonal2(const model::Square8& A) noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < kSize; ++i) {
      double row = 0.0;
      for (std::size_t j = i + 1; j < kSize; ++j) {
        row += A[i][j] * A[i][j];
      }
      sum += row;
    }
    return sum;
  }

  // Twice the angle that makes ij zero has the tangent 2 ij / (jj - ii). Computes the tangent of half the
  // angle, p / q, instead, which gives sine and cosine without a root.
  static Turn Angle(double ii, double jj, double ij) noexcept {
    const double h = 0.5 * std::fabs(jj - ii);
    const double blunt = 0.6532 * h + 0.6036 * std::fabs(ij);  // exact where the angle is 22.5 or 45 degrees
    const double q = 4.0 * (h > blunt ? h : blunt);
    const double p = jj < ii ? -ij : ij;
    const double sum = q * q + p * p;
    if (!(sum > 0.0)) {
      return {1.0, 0.0};
    }
    const double share = 1.0 / sum;
    return {(q * q - p * p) * share, 2.0 * p * q * share};
  }

  template <std::size_t kSize, std::size_t kTurn>
  static void TurnPair(model::Square8& A, Turns& turns) noexcept {
    constexpr std::size_t i = kPairs<kSize>[kTurn].i;
    constexpr std::size_t j = kPairs<kSize>[kTurn].j;
    const Turn by = Angle(A[i][i], A[j][j], A[i][j]);
    const double apart = A[j][j] - A[i][i];
    const double cs = by.c * by.s;
    const double ss = by.s * by.s;
    const double change = 2.0 * cs * A[i][j] - ss * apart;
    A[i][i] -= change;
    A[j][j] += change;
    A[i][j] = (1.0 - 2.0 * ss) * A[i][j] - cs * apart;
    turns[kTurn] = by;
  }

  template <std::size_t i, std::size_t j>
  static double& Entry(model::Square8& A) noexcept {
    return i < j ? A[i][j] : A[j][i];
  }

  // Rotates the entries where two pairs of one round cross.
  template <std::size_t kSize, std::size_t kTurn, std::size_t kOther>
  static void TurnCrossing(model::Square8& A, const Turns& turns) noexcept {
    if constexpr (kTurn < kOther) {
      constexpr Pair a = kPairs<kSize>[kTurn];
      constexpr Pair b = kPairs<kSize>[kOther];
      double& ii = Entry<a.i, b.i>(A);
      double& ij = Entry<a.i, b.j>(A);
      double& ji = Entry<a.j, b.i>(A);
      double& jj = Entry<a.j, b.j>(A);
      const Turn by = turns[kTurn];
      const Turn across = turns[kOther];
      const double up_i = by.c * ii - by.s * ji;
      const double up_j = by.c * ij - by.s * jj;
      const double down_i = by.s * ii + by.c * ji;
      const double down_j = by.s * ij + by.c * jj;
      ii = across.c * up_i - across.s * up_j;
      ij = across.s * up_i + across.c * up_j;
      ji = across.c * down_i - across.s * down_j;
      jj = across.s * down_i + across.c * down_j;
    }
  }

  template <std::size_t kSize, std::size_t kOne, std::size_t... kTurn>
  static void TurnCrossings(model::Square8& A, const Turns& turns,
                            std::index_sequence<kTurn...> /*of the round*/) noexcept {
    constexpr std::size_t kFirst = kOne / sizeof...(kTurn) * sizeof...(kTurn);
    (TurnCrossing<kSize, kOne, kFirst + kTurn>(A, turns), ...);
  }

  template <std::size_t kSize, std::size_t kRound, std::size_t... kTurn>
  static void Round(model::Square8& A, Turns& turns, std::index_sequence<kTurn...> of_round) noexcept {
    constexpr std::size_t kFirst = kRound * sizeof...(kTurn);
    (TurnPair<kSize, kFirst + kTurn>(A, turns), ...);
    (TurnCrossings<kSize, kFirst + kTurn>(A, turns, of_round), ...);
  }

  template <std::size_t kSize, std::size_t... kRound>
  static void Sweep(model::Square8& A, Turns& turns, std::index_sequence<kRound...> /*all*/) noexcept {
    (Round<kSize, kRound>(A, turns, std::make_index_sequence<kSize / 2>()), ...);
  }

  int sweeps_ = 0;
  std::array<Turns, kMaxSweeps> turns_;
};

}  // namespace fovea::model
