// SPDX-License-Identifier: Apache-2.0
// What was received in the last minute: rows of numbers over time, and pictures.

export const KEPT_S = 60;

// Rows of `width` numbers in the order of their time. The oldest are forgotten when `most` are kept.
export class Rows {
  constructor(width, most) {
    this.width = width;
    this.most = most;
    this.t = new Float64Array(2 * most);
    this.v = new Float32Array(2 * most * width);
    this.clear();
  }

  clear() {
    this.begin = 0;
    this.end = 0;
  }

  get size() {
    return this.end - this.begin;
  }

  // Adds a row at time t [s]; times only grow.
  add(t, values) {
    if (this.end === 2 * this.most) {
      // The kept half moves to the front, so that the rows stay in one piece.
      this.t.copyWithin(0, this.begin, this.end);
      this.v.copyWithin(0, this.begin * this.width, this.end * this.width);
      this.end -= this.begin;
      this.begin = 0;
    }
    this.t[this.end] = t;
    for (let i = 0; i < this.width; i++) {
      const value = values[i];
      this.v[this.end * this.width + i] = value === undefined || value === null ? NaN : value;
    }
    this.end++;
    if (this.size > this.most) this.begin++;
    while (this.t[this.begin] < t - KEPT_S - 1) this.begin++;
  }

  // Index of the last row at or before t, or begin - 1.
  at(t) {
    let low = this.begin;
    let high = this.end;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.t[middle] <= t) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  get(row, i) {
    return this.v[row * this.width + i];
  }

  // The last row at or before t, as a view into the rows; null when there is none within `reach` seconds.
  rowAt(t, reach = Infinity) {
    const row = this.at(t);
    if (row < this.begin || t - this.t[row] > reach) return null;
    return this.v.subarray(row * this.width, (row + 1) * this.width);
  }
}

// Pictures and their outlines, which come as messages of their own with the same stamp.
export class Pictures {
  constructor({ least_s, most_bytes }) {
    this.least_s = least_s; // the time between two pictures that are kept
    this.most_bytes = most_bytes;
    this.clear();
  }

  clear() {
    this.list = [];
    this.bytes = 0;
    this.last = null;
    this.outlines = new Map();
  }

  addPicture(t, jpeg) {
    const entry = { t, jpeg, outlines: this.outlines.get(t) || null };
    this.last = entry;
    const before = this.list[this.list.length - 1];
    if (!before || t - before.t >= this.least_s) {
      this.list.push(entry);
      this.bytes += jpeg.length;
    }
    while (this.list.length && (this.list[0].t < t - KEPT_S || this.bytes > this.most_bytes))
      this.bytes -= this.list.shift().jpeg.length;
    return entry;
  }

  addOutlines(t, outlines) {
    this.outlines.set(t, outlines);
    if (this.outlines.size > 8) this.outlines.delete(this.outlines.keys().next().value);
    const entry = this.last && this.last.t === t ? this.last : this.list.findLast((one) => one.t === t);
    if (entry) entry.outlines = outlines;
  }

  at(t) {
    return this.list.findLast((one) => one.t <= t + 1e-9) || null;
  }
}
