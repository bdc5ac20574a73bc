// SPDX-License-Identifier: Apache-2.0
// A slider with a field for the number. A number outside of its range is refused, and the range is named.

const { el, plain } = Fovea;

const rangeWords = ({ min, max, unit }) => `${plain(min, 6)} to ${plain(max, 6)}${unit ? ` ${unit}` : ""}`;

// A range over several powers of ten gets a logarithmic slider.
const isLog = ({ min, max }) => min > 0 && max / min >= 100;

// setting: {name, min, max, unit, value}; `label` names it to a person. onSet(value) is called with each accepted number.
export function numberField(setting, label, onSet) {
  const log = isLog(setting);
  const toSlider = (v) =>
    log
      ? Math.log(v / setting.min) / Math.log(setting.max / setting.min)
      : (v - setting.min) / (setting.max - setting.min);
  const fromSlider = (x) =>
    log ? setting.min * (setting.max / setting.min) ** x : setting.min + x * (setting.max - setting.min);
  let value = setting.value;
  let editing = false;
  const slider = el("input", { type: "range", min: 0, max: 1, step: 0.002, "aria-label": label });
  const field = el("input", {
    type: "text",
    inputmode: "decimal",
    class: "number-field",
    "aria-label": `${label}, ${rangeWords(setting)}`,
    autocomplete: "off",
    spellcheck: "false",
  });
  const refusal = el("p", { class: "refusal", role: "alert", hidden: true });
  const refuse = (words) => {
    refusal.hidden = !words;
    refusal.textContent = words || "";
    field.setAttribute("aria-invalid", String(!!words));
  };
  const show = (v) => {
    value = v;
    slider.value = toSlider(v);
    slider.setAttribute("aria-valuetext", `${plain(v, 4)}${setting.unit ? ` ${setting.unit}` : ""}`);
    if (!editing) field.value = String(parseFloat(v.toPrecision(5)));
  };
  slider.addEventListener("input", () => {
    refuse(null);
    editing = false;
    const v = parseFloat(fromSlider(Number(slider.value)).toPrecision(3));
    const inside = Math.min(setting.max, Math.max(setting.min, v));
    field.value = String(inside);
    onSet(inside);
  });
  field.addEventListener("input", () => (editing = true));
  const accept = () => {
    if (!editing) return;
    const v = field.value.trim() === "" ? NaN : Number(field.value.trim().replace(",", ".").replace("−", "-"));
    if (!(v >= setting.min && v <= setting.max)) {
      refuse(`“${field.value}” is refused: ${setting.name} takes ${rangeWords(setting)}.`);
      return;
    }
    editing = false;
    refuse(null);
    slider.value = toSlider(v);
    onSet(v);
  };
  field.addEventListener("change", accept);
  field.addEventListener("keydown", (event) => {
    if (event.key === "Enter") accept();
    if (event.key !== "Escape") return;
    editing = false;
    refuse(null);
    show(value);
  });
  show(value);
  return {
    slider,
    row: el(
      "div",
      { class: "number-row" },
      slider,
      field,
      setting.unit ? el("span", { class: "unit", text: setting.unit }) : null,
    ),
    refusal,
    show,
    enable(on) {
      slider.disabled = field.disabled = !on;
    },
  };
}
