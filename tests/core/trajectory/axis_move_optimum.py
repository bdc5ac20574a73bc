#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Least durations of jerk-limited moves of one axis, found without any knowledge of their shape.

The axis is a chain of three integrators whose jerk is constant in each of N equal steps of a move of duration T.
Position, velocity and acceleration at the steps' ends are then linear in the jerks, so "can it be at rest at the
goal after T within its limits?" is a linear programme; bisection finds the least such T. The programme knows
nothing of phases, peaks or switching times.

The steps make the jerk switch on a grid, which costs time. They also let the velocity exceed its limit between two
grid points, which saves time. Both errors are at worst about one step and shrink with it. Each case is solved with
N and N / 2 steps; the table gives the difference as the size of the error.

A developer's tool: it writes axis_move_optimum.csv, which axis_move_test.cpp reads. Needs python3-scipy.

    ./axis_move_optimum.py > axis_move_optimum.csv
"""

import random
import sys

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix

STEPS = 400
CASES = 300
SEED = 20


def feasible(duration, steps, v0, a0, distance, v_max):
    """True if the axis can move `distance` from (v0, a0) to rest in `duration`; limits of a and j are 1."""
    h = duration / steps
    # Unknowns: a_1..a_N, v_1..v_N, j_0..j_(N-1).
    rows, cols, values, right = [], [], [], []
    travel = np.zeros(3 * steps)
    known_travel = 0.0
    for k in range(steps):
        a_row, v_row = 2 * k, 2 * k + 1
        for row, col, value in (
            (a_row, k, 1.0),
            (a_row, 2 * steps + k, -h),
            (v_row, steps + k, 1.0),
            (v_row, 2 * steps + k, -h * h / 2),
        ):
            rows.append(row)
            cols.append(col)
            values.append(value)
        travel[2 * steps + k] += h**3 / 6
        if k == 0:
            right += [a0, v0 + h * a0]
            known_travel = h * v0 + h * h / 2 * a0
        else:
            rows += [a_row, v_row, v_row]
            cols += [k - 1, steps + k - 1, k - 1]
            values += [-1.0, -1.0, -h]
            right += [0.0, 0.0]
            travel[steps + k - 1] += h
            travel[k - 1] += h * h / 2
    last = 2 * steps
    used = np.nonzero(travel)[0]
    rows += [last] * len(used)
    cols += list(used)
    values += list(travel[used])
    right.append(distance - known_travel)
    matrix = coo_matrix((values, (rows, cols)), shape=(last + 1, 3 * steps)).tocsr()
    bounds = [(-1.0, 1.0)] * steps + [(-v_max, v_max)] * steps + [(-1.0, 1.0)] * steps
    bounds[steps - 1] = bounds[2 * steps - 1] = (0.0, 0.0)
    result = linprog(np.zeros(3 * steps), A_eq=matrix, b_eq=right, bounds=bounds, method="highs")
    return result.status == 0


def least_duration(steps, v0, a0, distance, v_max):
    high = 1.0
    while not feasible(high, steps, v0, a0, distance, v_max):
        high *= 1.5
        if high > 1e4:
            raise RuntimeError("no duration is long enough")
    low = 0.0 if high == 1.0 else high / 1.5
    while high - low > 4e-6 * high:
        middle = 0.5 * (low + high)
        if feasible(middle, steps, v0, a0, distance, v_max):
            high = middle
        else:
            low = middle
    return high


def stopping_distance(v, a):
    """The distance of full braking, by small steps; only used to draw goals near it."""
    x, h = 0.0, 1e-3
    sign = 1.0 if v + a * abs(a) / 2 > 0 else -1.0
    v, a = sign * v, sign * a
    while v > 0 or a > 0:
        a = max(a - h, -1.0) if v + a * abs(a) / 2 > 0 else a + h
        v += h * a
        x += h * v
    return sign * x


def draw(kind):
    """One start and distance, in units in which the limits of acceleration and jerk are 1."""
    v_max = 10 ** random.uniform(-0.7, 0.8)
    if kind == "rest":
        return 0.0, 0.0, random.choice([-1, 1]) * 10 ** random.uniform(-2, 1) * max(v_max, 0.5), v_max
    while True:
        v0, a0 = random.uniform(-1, 1) * v_max, random.uniform(-1, 1)
        if abs(v0 + a0 * abs(a0) / 2) <= 0.98 * v_max:
            break
    if kind == "near":  # the goal close to the end of full braking
        return v0, a0, stopping_distance(v0, a0) + random.choice([-1, 1]) * 10 ** random.uniform(-2.5, 0), v_max
    return v0, a0, random.uniform(-1, 1) * 10 ** random.uniform(-1, 1) * max(v_max, 0.5), v_max


def main():
    random.seed(SEED)
    print("# Least durations of a jerk-limited move of one axis to rest, by linear programming: see")
    print(f"# axis_move_optimum.py ({STEPS} steps, seed {SEED}). `error` is the difference to half the steps.")
    print("# kind, v0, a0, distance, v_max, a_max, j_max, duration_s, error_s")
    for case in range(CASES):
        kind = ("rest", "near", "any", "near", "any", "any")[case % 6]
        v0, a0, distance, v_max = draw(kind)
        fine = least_duration(STEPS, v0, a0, distance, v_max)
        coarse = least_duration(STEPS // 2, v0, a0, distance, v_max)
        # Convert to other units: a_max and j_max of any size.
        a_max, j_max = 10 ** random.uniform(-1, 2), 10 ** random.uniform(-1, 4)
        time = a_max / j_max
        length = a_max * time * time
        print(
            f"{kind},{v0 * length / time:.12g},{a0 * a_max:.12g},{distance * length:.12g},"
            f"{v_max * length / time:.12g},{a_max:.12g},{j_max:.12g},{fine * time:.7g},{(coarse - fine) * time:.2g}"
        )
        print(f"{case + 1}/{CASES}", end="\r", file=sys.stderr)


if __name__ == "__main__":
    main()
