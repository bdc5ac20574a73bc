// SPDX-License-Identifier: Apache-2.0
// How the page's plain canvases are drawn: by the processor. Where no GPU exists, a browser would draw them by an emulated
// one, which takes six times as long and slows the whole page down; small canvases gain little from a real one.
export const CPU_CANVAS = { willReadFrequently: true };
