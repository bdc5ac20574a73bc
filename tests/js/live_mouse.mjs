// SPDX-License-Identifier: Apache-2.0
// What a hand with a mouse does on the live page's bench.

// Where the bench's picture has the target or the hand, in the window.
const placeOf = (page, what) =>
  page.evaluate((name) => {
    const canvas = document.querySelector("#bench canvas");
    const box = canvas.getBoundingClientRect();
    const { x, y } = JSON.parse(canvas.dataset[name]);
    return { x: box.left + x * box.width, y: box.top + y * box.height };
  }, what);
export const targetAt = (page) => placeOf(page, "target");

// What `look` tells, as soon as it has told the same twice.
async function onceItStands(page, look) {
  for (let last, now = JSON.stringify(await look()); ; now = JSON.stringify(await look())) {
    if (now === last) return JSON.parse(now);
    last = now;
    await page.waitForTimeout(500);
  }
}

// The page scrolls smoothly to what is clicked: waits until the bench stands.
export const untilBenchStands = (page) =>
  onceItStands(page, () => page.evaluate(() => document.querySelector("#bench canvas").getBoundingClientRect().top));

// Waits until the hand of a paused run stands in the picture, too. Returns its place.
export const untilHandStands = (page) => onceItStands(page, () => placeOf(page, "hand"));

export async function drag(page, from, to) {
  await page.mouse.move(from.x, from.y);
  await page.waitForTimeout(150);
  await page.mouse.down();
  for (let i = 1; i <= 8; i++) {
    await page.mouse.move(from.x + ((to.x - from.x) * i) / 8, from.y + ((to.y - from.y) * i) / 8);
    await page.waitForTimeout(60);
  }
}

// The last move and the button's release without an answer between them: on a slow page it may come when the hand would
// long be still.
export async function letGoInMotion(page, x, y) {
  const browser = await page.context().newCDPSession(page);
  const send = (type, buttons) =>
    browser.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons, clickCount: 1 });
  await Promise.all([send("mouseMoved", 1), send("mouseReleased", 0)]);
  await browser.detach();
  await page.mouse.up(); // the button is up for the page; now for the test's own mouse, too
}
