// SPDX-License-Identifier: Apache-2.0
// The newest of what goes over the line of a board, as an agent tells it: [["<", AGE, BYTES], [">", AGE, BYTES]].

const kRows = 500;
const kLongest = 250; // of a line: what is longer is none

const time_text = (at) => {
  const time = new Date(at);
  const two = (number, digits = 2) => String(number).padStart(digits, "0");
  return `${two(time.getHours())}:${two(time.getMinutes())}:${two(time.getSeconds())}.${two(time.getMilliseconds(), 3)}`;
};
const escaped = (bytes) => bytes.replace(/[^ -~]|\\/g, (c) => ({ "\n": "\\n", "\r": "\\r", "\\": "\\\\" })[c] ?? `\\x${c.charCodeAt(0).toString(16).padStart(2, "0")}`);

export class Line {
  /// `left_out(n)`: a sentence.
  constructor(left_out) {
    this.left_out = left_out;
    this.clear();
  }

  clear() {
    this.pieces = [];
    this.lines = [];
    this.begun = { "<": "", ">": "" }; // lines that have no end yet
  }

  take({ line = [], dropped = 0 }, now) {
    for (const [direction, age, bytes] of line) {
      const at = now - age * 1000;
      this.pieces.push([at, direction, escaped(bytes)]);
      const parts = (this.begun[direction] + bytes).split(/[\r\n]+/);
      const rest = parts.pop();
      this.begun[direction] = rest.length > kLongest ? "" : rest;
      for (const part of rest.length > kLongest ? [...parts, rest] : parts) if (part) this.lines.push([at, direction, escaped(part)]);
    }
    if (dropped > 0) for (const rows of [this.pieces, this.lines]) rows.push([now, "!", this.left_out(dropped)]);
    for (const rows of [this.pieces, this.lines]) rows.splice(0, rows.length - kRows);
  }

  text(raw) {
    return (raw ? this.pieces : this.lines).map(([at, direction, text]) => `${time_text(at)} ${direction} ${text}\n`).join("");
  }
}
