// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { Line } from "../../../gateway/page/core/line.js";

const now = new Date(2026, 0, 2, 3, 4, 5, 678).getTime();
const line = () => new Line((n) => `${n} left out`);

test("Pieces_BecomeLinesWithTheirTimes_AndStayAsTheyCame", () => {
  const seen = line();
  seen.take({ line: [["<", 0.2, "@D,e,2,{4"], [">", 0.1, "S,W,0,90\r\n"], ["<", 0, "2,7}\n\x00\xff"]] }, now);
  assert.equal(seen.text(false), "03:04:05.578 > S,W,0,90\n03:04:05.678 < @D,e,2,{42,7}\n");
  assert.equal(seen.text(true), "03:04:05.478 < @D,e,2,{4\n03:04:05.578 > S,W,0,90\\r\\n\n03:04:05.678 < 2,7}\\n\\x00\\xff\n");
  seen.clear();
  assert.equal(seen.text(true), "");
});

test("WhatIsTooMuch_IsBoundedAndSaid", () => {
  const seen = line();
  seen.take({ line: [["<", 0, "x".repeat(1000)]], dropped: 12 }, now);
  assert.match(seen.text(false), /< x{1000}\n.* ! 12 left out\n$/);
  for (let i = 0; i < 2000; ++i) seen.take({ line: [["<", 0, `${i}\n`]] }, now);
  assert.equal(seen.text(false).split("\n").length, 501);
  assert.equal(seen.text(true).split("\n").length, 501);
});
