// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { fits, folded, row_of } from "../../../gateway/page/core/history.js";

const at = (second) => `2026-11-26T10:00:${String(second).padStart(2, "0")}.000Z`;
const command = (second, request, more = {}) => row_of({ board: "desk", at: at(second), what: "command", by: "ann", service: "servo", request, status: "ok", ...more });
const state = (second, now, was, board = "desk") => row_of({ board, at: at(second), what: "state", state: now, was });

test("a command is who, what and how it ended", () => {
  const row = command(1, '{"write":[0,90]}', { count: 3, status: "timeout" });
  assert.equal(row.text, "ann: Servo, write 0, 90");
  assert.equal(row.status, "no answer");
  assert.equal(row.times, 3);
  assert.equal(command(1, '{"write":[0,90]}', { by: "loopback", status: "error", reason: "INVALID_DEVICE_NUMBER" }).text, "this machine: Servo, write 0, 90, invalid device number");
  assert.equal(command(1, undefined, { by: "home-assistant", what: "stop" }).text, "Home Assistant: stopped it");
});

test("a link is named behind what it did, with its cause", () => {
  assert.equal(command(1, '{"write":[5,1]}', { by: "link warm, because desk/temperature was 30.5", service: "io" }).text, "Pins, write 5, 1, by link warm, because desk/temperature was 30.5");
});

test("a board that was stopped, and is resumed, says so", () => {
  const now = { board: "desk", at: at(1), what: "state", state: "online", was: "online" };
  assert.equal(row_of({ ...now, reason: "latched" }).text, "STOPPED until it is resumed");
  assert.equal(row_of(now).text, "resumed");
  assert.equal(row_of({ ...now, was: "lost" }).text, "was lost");
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
  const row = command(1, "W,0,90");
  assert.equal(fits(row, "ANN raw"), true);
  assert.equal(fits(row, "desk servo W,0,90"), true, "also as it was sent");
  assert.equal(fits(row, "bob"), false);
});
