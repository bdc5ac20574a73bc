// SPDX-License-Identifier: Apache-2.0
// A plot of signals that the reader chooses with a word search: one plot for each unit. The address keeps the choice.

Fovea.freePlot = (function () {
  const { el, plots } = Fovea;
  const COLOURS = 8;
  const MARK = "?show=";

  // The address is "#section?show=id,id": a section to jump to, and the chosen signals.
  function readAddress() {
    const at = location.hash.indexOf(MARK);
    const section = at < 0 ? location.hash.slice(1) : location.hash.slice(1, at);
    const ids =
      at < 0
        ? null
        : location.hash
            .slice(at + MARK.length)
            .split(",")
            .map(decodeURIComponent);
    return { section, ids };
  }

  function writeAddress(section, ids) {
    const show = ids.length ? MARK + ids.map(encodeURIComponent).join(",") : "";
    history.replaceState(null, "", `#${section}${show}`);
  }

  const unitWords = (unit) => (unit === "1" ? "no unit" : unit);

  function draw(runs) {
    const body = document.querySelector("#free .body");
    const signals = Fovea.signals.all(runs);
    if (!signals.length) {
      body.append(Fovea.absent("The log holds no signal over time."));
      return Fovea.drawn("free");
    }
    const asked = readAddress();
    const chosen = new Set((asked.ids || []).filter((id) => signals.some((s) => s.id === id)));
    const host = el("div", { class: "free-plots" });
    let shown = [];

    // One plot for each unit, in the order of the list; each signal keeps its colour while it is chosen.
    function replot() {
      shown.forEach((plot) => plot.remove());
      host.textContent = "";
      const picked = signals.filter((s) => chosen.has(s.id));
      shown = Array.from(new Set(picked.map((s) => s.unit))).map((unit) => {
        const here = picked.filter((s) => s.unit === unit);
        return plots.create(host, {
          label: `chosen signals [${unitWords(unit)}]`,
          height: 240,
          series: here.flatMap((signal, k) =>
            signal.series.map((s) => ({ ...s, colour: `--joint-${(k % COLOURS) + 1}`, width: 1.6 })),
          ),
        });
      });
      if (!picked.length) host.append(el("p", { class: "hint", text: "Nothing is chosen yet: tick signals above." }));
    }

    const boxes = signals.map((signal) => {
      const box = el("input", { type: "checkbox", value: signal.id, checked: chosen.has(signal.id) });
      const row = el("label", { class: "signal" }, box, el("span", { text: signal.name }));
      return { signal, box, row };
    });
    function choose(entry, on) {
      entry.box.checked = on;
      if (on) chosen.add(entry.signal.id);
      else chosen.delete(entry.signal.id);
    }
    function changed() {
      writeAddress("free", Array.from(chosen));
      replot();
    }
    boxes.forEach((entry) =>
      entry.box.addEventListener("change", () => {
        choose(entry, entry.box.checked);
        changed();
      }),
    );

    const groups = Array.from(new Set(signals.map((s) => s.unit))).map((unit) => {
      const members = boxes.filter(({ signal }) => signal.unit === unit);
      return {
        members,
        node: el(
          "fieldset",
          {},
          el("legend", { text: unitWords(unit) }),
          members.map(({ row }) => row),
        ),
      };
    });
    const count = el("span", { class: "hint", role: "status" });
    const search = el("input", {
      type: "search",
      "aria-label": "Search the signals by name or unit",
      placeholder: "search, for example: joint 3 velocity",
    });
    const found = () => boxes.filter(({ row }) => !row.hidden);
    function filter() {
      const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
      for (const { signal, row } of boxes) {
        const text = `${signal.name} ${unitWords(signal.unit)}`.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word));
      }
      groups.forEach(({ members, node }) => {
        node.hidden = members.every(({ row }) => row.hidden);
      });
      count.textContent = `${found().length} of ${signals.length} signals`;
    }
    search.addEventListener("input", filter);
    // The arrow keys move from the field into the list and back; Enter switches the first match.
    const move = (from, by) => {
      const list = found();
      const at = list.findIndex(({ box }) => box === from) + by;
      if (at < 0) search.focus();
      else if (list[at]) list[at].box.focus();
    };
    const picker = el("div", { class: "picker no-print" });
    picker.addEventListener("keydown", (event) => {
      if (event.key === "ArrowDown" || event.key === "ArrowUp") {
        move(event.target, event.key === "ArrowDown" ? 1 : -1);
        event.preventDefault();
      } else if (event.key === "Enter" && event.target === search && found().length) {
        const first = found()[0];
        choose(first, !first.box.checked);
        changed();
        event.preventDefault();
      }
    });
    const none = el("button", {
      type: "button",
      text: "Choose none",
      onclick: () => {
        boxes.forEach((entry) => choose(entry, false));
        changed();
      },
    });
    picker.append(
      el("div", { class: "toolbar" }, search, count, none, Fovea.zoomBar()),
      el(
        "div",
        { class: "signals" },
        groups.map(({ node }) => node),
      ),
    );
    body.append(picker);
    const key = Fovea.bands.legend(runs);
    if (key) body.append(key);
    body.append(host);
    filter();
    replot();
    // A link within the page would drop the choice from the address.
    addEventListener("hashchange", () => {
      const now = readAddress();
      if (now.ids === null && chosen.size) writeAddress(now.section, Array.from(chosen));
    });
    if (asked.ids !== null && asked.section) {
      const place = document.getElementById(asked.section);
      if (place) place.scrollIntoView();
    }
    Fovea.drawn("free");
  }

  return { draw };
})();
