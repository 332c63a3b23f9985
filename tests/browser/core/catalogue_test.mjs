// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { Catalogue, value_service } from "../../../gateway/page/core/catalogue.js";
import { reason_text } from "../../../gateway/page/core/text.js";

const board = (name, more = {}) => ({ board: name, state: "online", services: [{ name: "io" }], ...more });
const names = (rows) => rows.map((row) => row.name);

function catalogue(...boards) {
  const result = new Catalogue();
  for (const each of boards) result.apply({ event: "board", board: each });
  result.apply({ event: "snapshot-end", place: "e-1" });
  return result;
}

test("ReasonOfAState_IsSaidAsInEveryProgram", () => {
  const { states } = JSON.parse(readFileSync(new URL("../../vectors/reasons.json", import.meta.url)));
  for (const [reason, words] of Object.entries(states)) assert.equal(reason_text(reason), words);
});

test("Names_AreSortedAsPeopleCount", () => {
  assert.deepEqual(names(catalogue(board("uno10"), board("uno9"), board("Uno1")).view()), ["Uno1", "uno9", "uno10"]);
});

test("StateChange_KeepsTheRestAndSaysSinceWhen", () => {
  const all = catalogue(board("uno1"), board("uno2"));
  all.apply({ event: "state", at: "2026-01-01T00:00:00Z", was: "online", board: board("uno1", { state: "lost" }) });
  assert.deepEqual(names(all.view({ state: "lost" })), ["uno1"]);
  assert.equal(all.rows.get("uno1").since, Date.parse("2026-01-01T00:00:00Z"));
  assert.deepEqual([...all.counts()], [["lost", 1], ["online", 1]]);
});

test("AddedAndForgotten_AppearAndGo", () => {
  const all = catalogue(board("uno1"));
  all.apply({ event: "added", board: board("uno0") });
  assert.deepEqual(names(all.view()), ["uno0", "uno1"]);
  all.apply({ event: "forgotten", board: { board: "uno1" } });
  assert.deepEqual(names(all.view()), ["uno0"]);
});

test("Reset_KeepsRowsUntilTheSnapshotIsThere_ThenDropsWhatIsNotInIt", () => {
  const all = catalogue(board("uno1"), board("uno2"));
  all.apply({ event: "reset", reason: "past-gone" });
  all.apply({ event: "board", board: board("uno2") });
  assert.deepEqual(names(all.view()), ["uno1", "uno2"]);
  all.apply({ event: "snapshot-end", place: "e-9" });
  assert.deepEqual(names(all.view()), ["uno2"]);
});

test("Search_FindsEachWordInNameChipSketchAndServices", () => {
  const all = catalogue(board("kitchen", { chip: "ATmega328P", services: ["io", "servo"] }), board("hall", { sketch: "AsipHello" }));
  assert.deepEqual(names(all.view({ text: "SERVO kit" })), ["kitchen"]);
  assert.deepEqual(names(all.view({ text: "hello" })), ["hall"]);
  assert.deepEqual(names(all.view({ kind: "servo" })), ["kitchen"]);
  assert.deepEqual(names(all.view({ text: "nothing" })), []);
});

test("Search_FindsLabelsAndFriendlyNames", () => {
  const all = catalogue(board("a", { labels: { room: "lab", camera: "" } }), board("b", { names: { services: { io: "left arm" } } }));
  assert.deepEqual(names(all.view({ text: "room=lab camera" })), ["a"]);
  assert.deepEqual(names(all.view({ text: "LEFT arm" })), ["b"]);
  assert.deepEqual(all.view({ text: "lab" })[0].labels, ["room=lab", "camera"]);
});

test("EveryOrder_WorksInBothDirections", () => {
  const all = catalogue(board("a", { state: "lost", chip: "X", since: 1e12 }), board("b", { chip: "Y", since: 2e12, services: ["io", "servo"] }));
  for (const [sort, first] of [["name", "a"], ["state", "b"], ["services", "a"], ["chip", "a"], ["since", "b"]]) {
    assert.equal(all.view({ sort })[0].name, first, sort);
    assert.equal(all.view({ sort, descending: true })[1].name, first, sort);
  }
});

test("Group_OfEachValueOfALabel_BehindAHeading_ThoseWithoutItLast", () => {
  const of_room = (name, room) => board(name, { labels: { room, name: `nice ${name}` } });
  const all = catalogue(of_room("a", "lab"), board("b"), of_room("c", "attic"), of_room("d", "lab"), of_room("e", ""));
  const rows = all.view({ group: "room" });
  assert.deepEqual(rows.map((row) => row.group ?? row.name), ["room", "e", "room: attic", "c", "room: lab", "a", "d", "without room", "b"]);
  assert.deepEqual(rows.find((row) => row.group === "room: lab").names, ["a", "d"]);
  assert.deepEqual(all.label_keys(), ["room"]);
  assert.deepEqual(all.view({ group: "constructor" }).map((row) => row.group ?? row.name), ["without constructor", "a", "b", "c", "d", "e"]);
  assert.deepEqual(names(all.view({ text: "nice d" })), ["d"]);
});

test("BriefServices_AreReadFromText", () => {
  assert.deepEqual(catalogue(board("a", { services: "io distance" })).kinds(), ["distance", "io"]);
});

test("EventOfNoBoard_ChangesNothing", () => {
  const all = catalogue(board("a"));
  all.apply({ event: "status", broker: "lost" });
  all.apply({ event: "bookmark", place: "e-5" });
  assert.deepEqual(names(all.view()), ["a"]);
});

test("ValueOfARow_IsThatOfTheView_ElseOfTheBoardsLabel_ElseItsFirst", () => {
  const row = { services: ["io", "distance", "gas"], tags: { value: "gas" } };
  assert.equal(value_service(row, ""), "gas");
  assert.equal(value_service(row, "distance"), "distance");
  assert.equal(value_service(row, "-"), undefined);
  assert.equal(value_service({ ...row, tags: {} }, ""), "");
  assert.equal(value_service({ ...row, tags: { value: "none" } }, ""), "", "a label that names no service of it says nothing");
  assert.equal(value_service(row, "none"), undefined);
});
