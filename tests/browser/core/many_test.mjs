// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { for_each_board, lists_of, many_text, result_of } from "../../../gateway/page/core/many.js";

const boards = Array.from({ length: 100 }, (_, i) => `b${i}`);
const wait = () => Promise.resolve();

test("EachBoard_IsServedOnce_AFewAtATime", async () => {
  const served = [];
  let now = 0;
  let most = 0;
  const result = await for_each_board(boards, async (name) => {
    most = Math.max(most, ++now);
    await wait();
    --now;
    served.push(name);
  });
  assert.deepEqual(served.sort(), [...boards].sort());
  assert.deepEqual(result, { done: 100, failed: [] });
  assert.ok(most > 1 && most <= 8, `${most} at once`);
});

test("TooMuchAtOnce_IsTriedAgain_AndEndsWhereItNeverGoes", async () => {
  const tries = new Map();
  const busy = Object.assign(new Error("too many"), { status: 429 });
  const result = await for_each_board(["a", "b"], async (name) => {
    tries.set(name, (tries.get(name) ?? 0) + 1);
    if (name === "b" || tries.get(name) < 3) throw busy;
  }, { wait });
  assert.deepEqual(result, { done: 1, failed: [["b", "too many"]] });
  assert.equal(tries.get("a"), 3);
  assert.ok(tries.get("b") < 100);
});

test("WhatFails_IsNamedWithItsReason", async () => {
  let ended = 0;
  const result = await for_each_board(["a", "b", "c"], async (name) => {
    if (name === "b") throw new Error("it has no pin 99");
    return name === "c" ? "no proof in time" : undefined;
  }, { progress: (count) => { ended = count; } });
  assert.equal(ended, 3);
  assert.equal(many_text(result), "Done on 1 of 3 boards. b: it has no pin 99; c: no proof in time");
  assert.equal(many_text({ done: 1, failed: [] }), "Done on 1 board.");
  assert.match(many_text({ done: 0, failed: boards.map((name) => [name, "x"]) }), /b2: x … and 97 more$/);
});

test("NoBoards_IsNothing", async () => assert.deepEqual(await for_each_board([], () => assert.fail()), { done: 0, failed: [] }));

test("ThousandBoards_AreOneList_AndLongNamesAreAsManyAsFit", () => {
  const thousand = Array.from({ length: 1000 }, (_, i) => `student-${i}`);
  assert.deepEqual(lists_of(thousand), [thousand]);
  assert.deepEqual(lists_of([]), []);
  const long = Array.from({ length: 1000 }, (_, i) => String(i).padStart(64, "x"));
  const lists = lists_of(long);
  assert.equal(lists.length, 2);
  assert.deepEqual(lists.flat(), long);
  for (const names of lists) assert.ok(JSON.stringify({ boards: names }).length <= 65536);
});

test("OneAnswerForManyBoards_IsReadAsThatOfEach", () => {
  const answer = { boards: { a: { status: "ok" }, b: { status: "refused", error: "no such board" } } };
  assert.deepEqual(result_of(["a", "b", "c"], answer), { done: 1, failed: [["b", "no such board"], ["c", "no proof in time"]] });
  assert.deepEqual(result_of(["a"], undefined), { done: 0, failed: [["a", "no proof in time"]] });
});
