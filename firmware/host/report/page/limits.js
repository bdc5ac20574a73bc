// SPDX-License-Identifier: Apache-2.0
// The limits: what each watches, the key that sets it, and the share of it that a run used.

Fovea.limits = (function () {
  const { el, words, fixed, number } = Fovea;

  // A short form of firmware/GUARDS.md.
  const LIMITS = {
    joint_position: {
      of: "the distance of a joint's reference from the end of its range",
      key: "safety.joint_position_margin",
      then: "the joint slows down in time to stop there",
    },
    joint_velocity: {
      of: "the speed of a joint's reference",
      key: "safety.joint_velocity_fraction",
      then: "the motion slows down as a whole and keeps its direction",
    },
    joint_acceleration: {
      of: "the acceleration of a joint's reference",
      key: "safety.joint_acceleration_fraction",
      then: "the reference of that joint is delayed",
    },
    joint_jerk: {
      of: "the jerk of a joint's reference",
      key: "safety.joint_jerk_fraction",
      then: "the reference of that joint is delayed",
    },
    workspace: {
      of: "the distance of the end effector from the base",
      key: "safety.workspace_radius",
      then: "the end effector slides along the boundary",
    },
    torque: {
      of: "the torque command of a joint",
      key: "safety.torque_fraction",
      then: "the torque is cut to the range",
    },
    torque_rate: {
      of: "the change of a joint's torque command per tick",
      key: "safety.torque_rate_fraction",
      then: "the change is cut to the rate",
    },
    obstacle: {
      of: "the distance of hand and links from obstacles",
      key: "safety.planes",
      then: "the hand slides along the boundary",
    },
    cartesian_speed: {
      of: "the speed of the end effector",
      key: "safety.cartesian_speed",
      then: "the motion slows down as a whole",
    },
    rotation_speed: {
      of: "the angular speed of the end effector",
      key: "safety.rotation_speed",
      then: "the motion slows down as a whole",
    },
    singularity: {
      of: "the distance of the posture from a singularity",
      key: "safety.singularity_min",
      then: "the arm moves no nearer to it",
    },
    field_of_view: {
      of: "the distance of the target from the edge of the picture",
      key: "safety.view_margin_px",
      then: "the target slides along the edge",
    },
  };

  const percent = (share) => `${100 * share < 9.95 ? number(100 * share, 2) : fixed(100 * share, 0)} %`;

  // A key with "_fraction" is a share of the arm's own limit; the others are limits themselves.
  const ofWhat = (name) =>
    LIMITS[name] && LIMITS[name].key.endsWith("_fraction") ? "of the arm's own limit" : "of the limit";

  // Which limit acted, on what, for how long; null when it did not.
  function actedWords(run, name) {
    const s = run.summary || {};
    const ticks = s.limit_ticks ? s.limit_ticks[name] : 0;
    if (!ticks) return null;
    const limit = LIMITS[name];
    const value = limit ? Fovea.setting(run, limit.key) : null;
    const which = limit ? `the servo's limit ${limit.key}${value === null ? "" : ` = ${value}`}` : "the servo's limit";
    const what = limit ? ` on ${limit.of}` : "";
    const tick_s = Number.isFinite(s.ticks) && s.ticks > 0 ? run.duration_s / s.ticks : 0.001;
    return `${which}${what} acted in ${Fovea.plural(ticks, "tick")} (${number(ticks * tick_s, 3)} s)${limit ? `: ${limit.then}` : ""}`;
  }

  // The limits of which a run has a used share or in which the servo acted.
  function namesOf(runs) {
    const names = ({ limits, limit_ticks }) => [...Object.keys(limits || {}), ...Object.keys(limit_ticks || {})];
    return Array.from(new Set(runs.flatMap((run) => names(run.summary || {})))).sort();
  }

  // The largest used share of every limit, as bars; one bar for each run. A limit without a share, such as the
  // field of view, has its words alone.
  function bars(runs) {
    const names = namesOf(runs);
    if (!names.length) return null;
    const bar = (run, name) => {
      const share = run.summary && run.summary.limits ? run.summary.limits[name] : undefined;
      const acted = actedWords(run, name);
      const letter = runs.length > 1 ? `${run.letter}: ` : "";
      if (!Number.isFinite(share)) {
        if (!acted) return null;
        return el(
          "div",
          { class: `share run-${run.index}` },
          el("span", { class: "share-text", text: letter + acted }),
        );
      }
      const over = share > 1 + 1e-6;
      const text = `at most ${percent(share)} ${ofWhat(name)}${over ? ", exceeded" : ""}${acted ? `; ${acted}` : ""}`;
      return el(
        "div",
        { class: `share run-${run.index}` },
        el(
          "div",
          { class: "share-track", "aria-hidden": "true" },
          el("div", {
            class: over ? "share-fill over" : "share-fill",
            style: `width:${Math.min(100, 100 * share).toFixed(1)}%`,
          }),
        ),
        el("span", { class: "share-text", text: letter + text }),
      );
    };
    return el(
      "div",
      { class: "shares" },
      el("h3", { text: "Largest used share of each limit" }),
      el(
        "dl",
        {},
        names.map((name) =>
          el(
            "div",
            { class: "share-row" },
            el("dt", { text: words(name) }),
            el(
              "dd",
              {},
              runs.map((run) => bar(run, name)),
            ),
          ),
        ),
      ),
    );
  }

  return { bars, percent, ofWhat };
})();
