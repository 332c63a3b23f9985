// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { fits, folded, row_of } from "../../../gateway/page/core/history.js";

const at = (second) => `2026-11-26T10:00:${String(second).padStart(2, "0")}.000Z`;
const command = (second, request, more = {}) => row_of({ board: "desk", at: at(second), what: "command", by: "ann", service: "servo", request, status: "ok", ...more });
const state = (second, now, was, board = "desk") => row_of({ board, at: at(second), what: "state", state: now, was });

test("a command is who, what and how it ended", () => {
  const row = command(1, "write 0 90", { count: 3 });
  assert.equal(row.text, "ann: servo write 0 90");
  assert.equal(row.status, "ok");
  assert.equal(row.times, 3);
});

test("what was asked is words, not the wire", () => {
  const text = (request, by = "ann") => command(1, request, { by }).text;
  assert.equal(text('{"write":[0,90]}', "loopback"), "this machine: servo write 0, 90");
  assert.equal(text('{"stop-all":true}'), "ann: servo stop-all");
  assert.equal(text('{"write":{"servo":0,"angle":9}}'), "ann: servo write servo 0, angle 9");
  assert.equal(text('{"labels":{"room":"lab"}}'), "ann: servo names and labels");
  assert.equal(text('{"set":[[{"pixel":3}]]}'), "ann: servo set …");
  for (const odd of ["{", "7", "null", "{}", "I,d,13,1"]) assert.equal(text(odd), `ann: servo ${odd}`);
});

test("equal rows are one, with how often and since when", () => {
  const rows = folded([command(9, "write 0 90"), command(8, "write 0 90"), command(7, "write 0 90", { count: 4 }), command(6, "write 0 10")]);
  assert.deepEqual(rows.map((row) => row.times), [6, 1]);
  assert.equal(rows[0].until, Date.parse(at(7)));
  assert.equal(rows[0].at, Date.parse(at(9)));
});

test("a board that comes and goes is two rows", () => {
  const rows = [];
  for (let i = 20; i > 0; i -= 2) rows.push(state(i, "lost", "online"), state(i - 1, "online", "lost"));
  assert.deepEqual(folded(rows).map((row) => [row.state, row.times]), [["lost", 10], ["online", 10]]);
});

test("rows of other boards, and those with another end, are not folded", () => {
  assert.equal(folded([state(3, "lost", "online"), state(2, "lost", "online", "lamp"), state(1, "lost", "online")]).length, 3);
  assert.equal(folded([command(2, "write 0 90"), command(1, "write 0 90", { status: "timeout" })]).length, 2);
});

test("each word is looked for, whatever its case", () => {
  const row = command(1, "write 0 90");
  assert.equal(fits(row, "ANN write"), true);
  assert.equal(fits(row, "desk servo 90"), true);
  assert.equal(fits(row, "bob"), false);
});
