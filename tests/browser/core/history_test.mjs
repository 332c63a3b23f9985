// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { fits, folded, renewed, row_of, some_of } from "../../../gateway/page/core/history.js";

const at = (second) => `2026-11-26T10:00:${String(second).padStart(2, "0")}.000Z`;
const command = (second, request, more = {}) => row_of({ board: "desk", at: at(second), what: "command", by: "ann", service: "servo", request, status: "ok", ...more });
const state = (second, now, was, board = "desk") => row_of({ board, at: at(second), what: "state", state: now, was });

test("a command is a sentence: what, by whom, and what went wrong", () => {
  assert.equal(command(1, '{"write":[0,90]}', { count: 3, status: "timeout" }).text, "Servo, write 0, 90, by ann: the board gave no proof in time");
  assert.equal(command(1, '{"write":[0,90]}', { by: "loopback", status: "error", reason: "INVALID_DEVICE_NUMBER" }).text, "Servo, write 0, 90, by this machine: error, invalid device number");
  assert.equal(command(1, '{"write":[0,90]}', { by: "node-red", status: "refused", reason: "stopped" }).text, "Servo, write 0, 90, by Node-RED: the board was stopped");
  assert.equal(command(1, '{"write":[0,90]}', { by: "(unnamed)", status: "sent" }).text, "Servo, write 0, 90, by a program that gives no name");
  assert.equal(command(1, undefined, { by: "home-assistant", what: "stop" }).text, "Stopped, by Home Assistant");
  assert.equal(command(1, '{"write":[0,90]}', { what: "undone" }).text, "Not renewed, undone: Servo, write 0, 90, by ann");
});

test("a link is named behind what it did, with its cause", () => {
  assert.equal(command(1, '{"write":[5,1]}', { by: "link warm, because desk/temperature was 30.5", service: "io" }).text, "Pins, write 5, 1, by link warm, because desk/temperature was 30.5");
});

test("a board that was stopped, and is resumed, says so", () => {
  const now = { board: "desk", at: at(1), what: "state", state: "online", was: "online" };
  assert.equal(row_of({ ...now, reason: "latched" }).text, "STOPPED until it is resumed");
  assert.equal(row_of(now).text, "resumed");
  assert.equal(row_of({ ...now, was: "lost" }).text, "was lost");
  assert.equal(row_of({ board: "desk", at: at(1), what: "forgotten" }).text, "Forgotten");
});

test("what befell many boards at once is one row, what befell two is two", () => {
  const lost = (second, board) => row_of({ board, at: at(second), what: "state", state: "lost", was: "online", reason: "agent-gone" });
  const rows = folded(Array.from({ length: 2000 }, (_, i) => lost(5 - Math.floor(i / 1000), `board${i}`)).concat(lost(3, "board7")));
  assert.deepEqual(rows.map((row) => [row.state, row.boards.length, row.at - row.until]), [["lost", 2000, 2000]]);
  assert.equal(rows[0].text, "its agent died or lost the broker");
  assert.equal(folded([lost(5, "a"), lost(5, "b")]).length, 2);
  assert.equal(folded([lost(30, "a"), lost(20, "b"), lost(10, "c")]).length, 3, "each by itself");
});

test("a robot at twenty commands a second is one row, and what happened between them is seen", () => {
  const driven = (second) => command(second, `{"power":[0,${second * 3}]}`, { by: "node-red", service: "motors", count: 20, status: second === 7 ? "timeout" : "ok" });
  const rows = [...Array.from({ length: 29 }, (_, i) => driven(59 - i)), state(30, "online", "lost"), ...Array.from({ length: 29 }, (_, i) => driven(29 - i)), command(0, undefined, { what: "stop" })];
  assert.deepEqual(folded(rows, false).map((row) => row.text), ["580 commands, by Node-RED", "was lost", "580 commands, by Node-RED: 20 were not executed", "Stopped, by ann"]);
  assert.equal(folded(rows, true).length, rows.length);
  assert.equal(folded([driven(1), driven(2), driven(3)], false).length, 3, "a few are told");
});

test("names of many are three, and how many more", () => {
  assert.equal(some_of(["a", "b", "c"]), "a, b, c");
  assert.equal(some_of(["a", "b", "c", "d", "e"]), "a, b, c and 2 more");
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

test("what is new comes before what is there, the oldest go, and they can be loaded again", () => {
  const rows = (from, count, cursor) => {
    const made = Array.from({ length: count }, (_, i) => ({ board: "desk", at: (from - i) * 1000, text: "Servo 0", raw: `ann ${from - i}` }));
    if (cursor) made.at(-1).cursor = cursor;
    return made;
  };
  const seconds = (all) => all.map((row) => row.at / 1000);
  const there = [...rows(10, 4, "at 7"), ...rows(6, 6, "at 1")];
  const more = renewed(there, rows(13, 5, "at 9"), 100);
  assert.deepEqual(seconds(more), [13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1]);
  assert.equal(more.at(-1).cursor, "at 1");
  const cut = renewed(there, rows(13, 5, "at 9"), 12);
  assert.deepEqual([seconds(cut), cut.at(-1).cursor], [[13, 12, 11, 10, 9, 8, 7], "at 7"], "at the end of a page, never between");
  assert.equal(renewed(there, rows(20, 5), 100), undefined, "there is a gap");
  assert.equal(renewed(there, [], 100), undefined);
  // A robot for an hour, a look each five seconds: never again from its beginning.
  let all = [...rows(5000, 50, "at 4951"), ...rows(4950, 1000, "at 3951"), ...rows(3950, 1000, "at 2951"), ...rows(2950, 1000, "at 1951"), ...rows(1950, 1000, "at 951")];
  for (let now = 5005; now <= 8600; now += 5) {
    all = renewed(all, rows(now, 50, `at ${now - 49}`), 5000);
    assert.ok(all.length > 2000 && all.length <= 5000, `${all.length} at ${now}`);
    assert.equal(all.at(-1).cursor, `at ${all.at(-1).at / 1000}`);
    assert.equal(all[0].at - all.at(-1).at, (all.length - 1) * 1000, "no row is missing");
  }
});
