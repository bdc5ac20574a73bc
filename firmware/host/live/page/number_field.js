// SPDX-License-Identifier: Apache-2.0
// A slider with a field for the number. A number outside of its range is refused, and the range is named.

const { el, plain } = Fovea;

const rangeWords = ({ min, max, unit }) => `${plain(min, 6)} to ${plain(max, 6)}${unit ? ` ${unit}` : ""}`;

const STEPS = 500; // of a slider
const LEAST_SHARE = 1e-3; // of a range's larger end: where a slider through 0 changes from linear to logarithmic
const WIDE = 10; // times the usual value: a range through 0 that is wider than this gets such a slider

// How a range is spread over a slider: {least, most, place(v), at(place)}; places are whole numbers.
function scaleOf({ min, max, whole, value, default: usual = value }) {
  if (whole) return { least: min, most: max, place: (v) => v, at: (place) => place };
  const reach = Math.max(Math.abs(min), Math.abs(max));
  const unit = LEAST_SHARE * reach;
  let [bend, straighten] = [(v) => v, (x) => x];
  if (min > 0 && max / min >= 100) [bend, straighten] = [Math.log, Math.exp];
  else if (min <= 0 && max >= 0 && reach > WIDE * (Math.abs(usual) || 1))
    [bend, straighten] = [(v) => Math.asinh(v / unit), (x) => unit * Math.sinh(x)];
  const [from, to] = [bend(min), bend(max)];
  const place = (v) => Math.round((STEPS * (bend(v) - from)) / (to - from));
  const at = (step) => {
    if (min <= 0 && max >= 0 && step === place(0)) return 0;
    return parseFloat(straighten(from + (step * (to - from)) / STEPS).toPrecision(3));
  };
  return { least: 0, most: STEPS, place, at };
}

// setting: {name, min, max, unit, value}, optional default and `whole` (it takes whole numbers); `label` names it to a
// person. onSet(value) is called with each accepted number.
export function numberField(setting, label, onSet) {
  const scale = scaleOf(setting);
  let value = setting.value;
  let editing = false;
  const slider = el("input", { type: "range", min: scale.least, max: scale.most, "aria-label": label });
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
    slider.value = scale.place(v);
    slider.setAttribute("aria-valuetext", `${plain(v, 4)}${setting.unit ? ` ${setting.unit}` : ""}`);
    if (!editing) field.value = String(parseFloat(v.toPrecision(5)));
  };
  slider.addEventListener("input", () => {
    refuse(null);
    editing = false;
    const inside = Math.min(setting.max, Math.max(setting.min, scale.at(Number(slider.value))));
    field.value = String(inside);
    onSet(inside);
  });
  field.addEventListener("input", () => (editing = true));
  const accept = () => {
    if (!editing) return;
    const typed = field.value.trim() === "" ? NaN : Number(field.value.trim().replace(",", ".").replace("−", "-"));
    const v = setting.whole ? Math.round(typed) : typed;
    if (!(v >= setting.min && v <= setting.max)) {
      refuse(`“${field.value}” is refused: ${setting.name} takes ${rangeWords(setting)}.`);
      return;
    }
    editing = false;
    refuse(null);
    slider.value = scale.place(v);
    if (setting.whole) field.value = String(v);
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
