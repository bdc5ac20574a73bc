// SPDX-License-Identifier: Apache-2.0
// What the run tells so far of the values that the servo believes.

const { el } = Fovea;

// With the digits that the standard deviation needs. Without a configured number: the difference, signed.
function found({ known, configured, difference, sigma, unit }) {
  if (!known) return "unknown";
  const digits = Math.min(6, Math.max(0, -Math.floor(Math.log10(Math.max(sigma, 1e-6)))));
  const isWhole = configured !== null;
  const value = isWhole ? configured + difference : difference;
  const sign = value < 0 ? "−" : isWhole ? "" : "+";
  return `${sign}${Math.abs(value).toFixed(digits)} ± ${sigma.toFixed(digits)} ${unit}${isWhole ? "" : " off"}`;
}

export class Findings {
  #shown = null;

  constructor(host, model) {
    this.section = host.closest("section");
    this.section.hidden = true;
    this.rows = el("tbody");
    const head = ["Belief", "Found"].map((text) => el("th", { scope: "col", text }));
    host.append(el("table", { class: "findings" }, el("thead", {}, el("tr", {}, ...head)), this.rows));
    model.listen((what) => {
      if (what === "state") this.#show(model.state.findings || []);
    });
  }

  // The table is made again only when a figure has changed.
  #show(findings) {
    const text = JSON.stringify(findings);
    if (text === this.#shown) return;
    this.#shown = text;
    this.section.hidden = !findings.length;
    this.rows.replaceChildren(
      ...findings.map((finding) =>
        el(
          "tr",
          { class: finding.known ? null : "unknown" },
          el(
            "th",
            { scope: "row", title: finding.key || null },
            finding.name,
            finding.configured === null
              ? null
              : el("span", { class: "note", text: `configured ${finding.configured} ${finding.unit}` }),
          ),
          el("td", { text: found(finding) }),
        ),
      ),
    );
  }
}
