// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { is_source, is_target, rule_of, standing_of, value_of, ways_of } from "../../../gateway/page/core/rule.js";

const button = { id: "io/2", service: "io", kind: "binary", type: "boolean", access: "read", meaning: { class: "button" } };
const contact = { ...button, id: "io/3", meaning: undefined };
const led = { id: "io/13", service: "io", kind: "switch", access: "both" };
const distance = { id: "distance/0", service: "distance", kind: "sensor", type: "integer", access: "read" };
const angle = { id: "servo/0/angle", service: "servo", kind: "number", type: "integer", access: "both" };
const ways = (source, target) => ways_of(source, target).map((each) => each.when);

test("LikeliestWay_IsTheFirst", () => {
  assert.deepEqual(ways(button, led), ["toggles", "follows", "inverted", "hold", "double"]);
  assert.deepEqual(ways(contact, led), ["follows", "inverted", "toggles"]);
  assert.deepEqual(ways(distance, led), ["above", "below"]);
  assert.deepEqual(ways(distance, angle), ["above", "below", "follows"]);
  assert.deepEqual(ways(button, angle), ["follows", "inverted", "hold", "double"], "nothing to switch to");
  assert.deepEqual(ways(undefined, undefined), []);
});

test("Values_AreAskedFor_WhereTheTargetIsNeitherOnNorOff", () => {
  assert.deepEqual(ways_of(distance, angle).map((each) => each.values), [true, true, false]);
  assert.ok(ways_of(button, led).every((each) => !each.values && !each.level));
  assert.ok(ways_of(distance, led).every((each) => each.level));
});

test("FloatingPins_AndPulses_AreNotOffered", () => {
  assert.ok(!is_source({ id: "io/14", service: "io", kind: "sensor", type: "integer", access: "read", advanced: true }));
  assert.ok(!is_source({ kind: "sensor", type: "string", access: "read" }));
  assert.ok(is_source(button) && is_source(distance) && is_source(led));
  assert.ok(is_target(led) && is_target(angle) && !is_target(distance) && !is_target({ kind: "button", access: "write" }));
});

test("Typed_IsRead_AndWhatIsEmptyIsLeftOut", () => {
  assert.deepEqual(rule_of("desk/distance/0", "servo/0/angle", "above", { level: "30", back: " ", value: "90", otherwise: "off" }),
    { name: "desk-distance-0-servo-0-angle", from: "desk/distance/0", when: "above", to: "servo/0/angle", level: 30, value: 90, else: false });
  assert.deepEqual([value_of(" 4.5 "), value_of("on"), value_of("red")], [4.5, true, "red"]);
  assert.ok(rule_of("b".repeat(63) + "/io/2", "io/13", "follows").name.length <= 63);
});

test("Standing_SaysWhatToDo", () => {
  const link = { board: "lamp", from: "desk/io/2", state: "on" };
  assert.equal(standing_of(link, true).text, "on");
  assert.equal(standing_of({ ...link, disabled: true }, true).text, "off");
  assert.equal(standing_of({ ...link, state: "until the source changes", suspended: true }, true).text, "waits until its source changes");
  const silent = { ...link, state: "desk is not heard" };
  assert.match(standing_of(silent, true).text, /asipctl secure link lamp desk/);
  assert.equal(standing_of(silent, false).text, "desk is not heard");
});
