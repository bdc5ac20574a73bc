// SPDX-License-Identifier: Apache-2.0
// The colours of the page, and what to do when they change.

Fovea.theme = (function () {
  const { listen, tell: tellAll } = Fovea.callbacks();
  const known = new Map();
  const tell = () => {
    known.clear();
    tellAll();
  };
  const theme = {
    // The value of a custom property of the page, for painting on a canvas.
    colour(name) {
      if (!known.has(name)) known.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
      return known.get(name);
    },
    listen,
    tell,
    printing: false,
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => tell());
  const print = (on) => () => {
    if (theme.printing === on) return;
    theme.printing = on;
    document.documentElement.classList.toggle("printing", on);
    const folded = document.querySelectorAll(on ? "details:not([open], .folded-on-paper)" : "details.opened-for-print");
    folded.forEach((node) => {
      node.open = on;
      node.classList.toggle("opened-for-print", on);
    });
    tell();
  };
  addEventListener("beforeprint", print(true));
  addEventListener("afterprint", print(false));
  return theme;
})();
