// SPDX-License-Identifier: Apache-2.0
// A QR code (ISO/IEC 18004) of an address: bytes, error correction L, versions 1 to 5, which have one block. Readers take any mask.

const kData = [19, 34, 55, 80, 108]; // bytes, with those below all that a version holds
const kCheck = [7, 10, 15, 20, 26];
const kMask = (row, column) => (row + column) % 2 === 0;
const kFormat = 0x77c4; // level L, that mask

const powers = [];
const logs = [];
for (let i = 0, value = 1; i < 255; ++i) {
  powers[i] = value;
  logs[value] = i;
  value = value < 128 ? value * 2 : (value * 2) ^ 0x11d;
}
const times = (a, b) => (a && b ? powers[(logs[a] + logs[b]) % 255] : 0);

/// The remainder of the data by the product of (x - 2^i): what finds and mends faults.
function check_bytes(data, count) {
  let generator = [1];
  for (let i = 0; i < count; ++i) generator = [...generator, 0].map((each, at) => each ^ times(generator[at - 1] ?? 0, powers[i]));
  const rest = [...data, ...new Array(count).fill(0)];
  for (let i = 0; i < data.length; ++i) generator.map((each) => times(each, rest[i])).forEach((each, at) => { rest[i + at] ^= each; });
  return rest.slice(data.length);
}

function bytes_of(text, version) {
  const bytes = [...new TextEncoder().encode(text)];
  const nibbles = [4, bytes.length >> 4, bytes.length & 15, ...bytes.flatMap((each) => [each >> 4, each & 15]), 0];
  const data = [];
  for (let i = 0; i < nibbles.length; i += 2) data.push(nibbles[i] * 16 + nibbles[i + 1]);
  for (let i = 0; data.length < kData[version - 1]; ++i) data.push(i % 2 ? 0x11 : 0xec);
  return [...data, ...check_bytes(data, kCheck[version - 1])];
}

/// What does not depend on the text: [row][column] is true (dark), false, or undefined where bits go.
function frame_of(version) {
  const size = 17 + 4 * version;
  const rows = Array.from({ length: size }, () => new Array(size));
  const square = (row, column, radius, rings) => {
    for (let y = -radius; y <= radius; ++y)
      for (let x = -radius; x <= radius; ++x)
        if (rows[row + y] && column + x >= 0 && column + x < size) rows[row + y][column + x] = !rings.includes(Math.max(Math.abs(x), Math.abs(y)));
  };
  for (const [row, column] of [[3, 3], [3, size - 4], [size - 4, 3]]) square(row, column, 4, [2, 4]);
  if (version > 1) square(size - 7, size - 7, 2, [1]);
  for (let i = 8; i < size - 8; ++i) rows[6][i] = rows[i][6] = i % 2 === 0;
  for (let i = 0; i < 15; ++i) {
    const bit = ((kFormat >> i) & 1) === 1;
    rows[i < 6 ? i : i < 8 ? i + 1 : size - 15 + i][8] = bit;
    rows[8][i < 8 ? size - 1 - i : i < 9 ? 7 : 14 - i] = bit;
  }
  rows[size - 8][8] = true;
  return rows;
}

/// Rows of true (dark) and false; undefined where the text is longer than 106 bytes.
export function qr_of(text) {
  const version = kData.findIndex((size) => new TextEncoder().encode(text).length + 2 <= size) + 1;
  if (version === 0) return undefined;
  const bytes = bytes_of(text, version);
  const rows = frame_of(version);
  const size = rows.length;
  let bit = 0;
  for (let right = size - 1, up = true; right > 0; right -= 2, up = !up) {
    if (right === 6) right = 5;
    for (let i = 0; i < size; ++i) {
      const row = rows[up ? size - 1 - i : i];
      for (const column of [right, right - 1]) {
        if (row[column] !== undefined) continue;
        row[column] = (((bytes[bit >> 3] ?? 0) >> (7 - (bit & 7))) & 1) === 1;
        if (kMask(rows.indexOf(row), column)) row[column] = !row[column];
        ++bit;
      }
    }
  }
  return rows;
}
