// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { changed_labels, changed_names, labels_text, parse_assignments, parse_labels } from "../../../gateway/page/core/labels.js";

test("Labels_AreReadAsTheyAreWritten", () => {
  const labels = { room: "lab", camera: "", name: "left desk" };
  assert.equal(labels_text(labels), "room=lab, camera");
  assert.deepEqual(parse_labels(" room=lab ,camera,, "), { room: "lab", camera: "" });
  assert.deepEqual(parse_labels("formula=a=b"), { formula: "a=b" });
});

test("Change_SaysOnlyWhatIsOther_AndNullForWhatGoes", () => {
  const now = { room: "lab", camera: "", name: "left desk" };
  assert.deepEqual(changed_labels(now, "room=lab, camera", "left desk"), {});
  assert.deepEqual(changed_labels(now, "room=hall", "left desk"), { room: "hall", camera: null });
  assert.deepEqual(changed_labels(now, "room=lab, camera", ""), { name: null });
  assert.deepEqual(changed_labels({}, "", "desk of Ann"), { name: "desk of Ann" });
  assert.deepEqual(changed_names({ servo: "arm" }, new Map([["servo", ""], ["distance", "front"], ["io", ""]])), { servo: null, distance: "front" });
});

test("LabelWithAComma_StaysWhereNothingIsTyped", () => {
  assert.deepEqual(changed_labels({ note: "a, b" }, "note=a, b", ""), {});
});

test("Blanks_StandBetweenLabelsAsInAsipctl_WhereThereIsNoComma", () => {
  assert.deepEqual(parse_labels(" room=lab  camera shelf=2"), { room: "lab", camera: "", shelf: "2" });
  assert.deepEqual(parse_labels("room=big hall, camera"), { room: "big hall", camera: "" });
});

test("Assignments_SetOrRemove_OrAreNone", () => {
  assert.deepEqual(parse_assignments("room=lab"), { room: "lab" });
  assert.deepEqual(parse_assignments(" retired "), { retired: "" });
  assert.deepEqual(parse_assignments("room-"), { room: null });
  assert.deepEqual(parse_assignments("room=lab old- camera"), { room: "lab", old: null, camera: "" });
  assert.deepEqual(parse_assignments("room=big hall, old-"), { room: "big hall", old: null });
  assert.equal(parse_assignments(""), undefined);
  assert.equal(parse_assignments("=lab"), undefined);
});
