// SPDX-License-Identifier: Apache-2.0
// A button that copies a text.

Fovea.copyButton = function (text, words = "Copy") {
  const { el } = Fovea;
  const button = el("button", { type: "button", class: "copy no-print", text: words });
  const say = (ok) => {
    button.textContent = ok ? "Copied" : "Select and copy by hand";
    setTimeout(() => {
      button.textContent = words;
    }, 2000);
  };
  const byHand = () => {
    const area = el("textarea", { class: "offscreen", "aria-hidden": "true" });
    area.value = text;
    document.body.append(area);
    area.select();
    const ok = document.execCommand("copy");
    area.remove();
    say(ok);
  };
  button.addEventListener("click", () => {
    if (navigator.clipboard && isSecureContext) navigator.clipboard.writeText(text).then(() => say(true), byHand);
    else byHand();
  });
  return button;
};
