// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { elements_of, is_on, place_in, range_of, raw_of, set_by, value_text } from "../../../gateway/page/core/properties.js";

const switch_of = (off, on) => ({ id: "io/13", service: "io", kind: "switch", choices: [["off", off], ["on", on]], write: { command: "write", args: [13, null] } });
const angle = (n) => ({ id: `servo/${n}/angle`, service: "servo", kind: "number", type: "integer", min: 0, max: 180, unit: "degrees", write: { command: "write", args: [n, null] } });
const lamp = { id: "io/5", service: "io", kind: "light", max: 255, write: { command: "pwm", args: [5, null] } };

test("Elements_AreThoseThatTheBoardHas", () => {
  const list = [angle(1), angle(0), { id: "servo/stop", service: "servo", kind: "button", write: { command: "write", args: [] } }, { id: "distance/7", service: "distance" }];
  assert.deepEqual(elements_of(list, "servo"), [0, 1]);
  assert.deepEqual(elements_of(list, "distance"), [7]);
  assert.deepEqual(elements_of([{ id: "humidity", service: "humidity" }], "humidity"), []);
  assert.deepEqual(set_by(list, "servo", "write").map((each) => each.id), ["servo/1/angle", "servo/0/angle"]);
});

test("NotKnown_IsNeitherOffNorZero", () => {
  assert.equal(is_on(undefined), undefined);
  assert.equal(is_on(null), undefined);
  assert.equal(is_on(0), false);
  assert.equal(is_on({ on: true }), true);
  assert.equal(place_in(undefined), undefined);
  assert.equal(place_in({ on: false }), 0);
  assert.equal(value_text(angle(0), null), "");
  assert.equal(raw_of(angle(0), undefined), undefined);
});

test("Values_AreInWords", () => {
  assert.equal(value_text({ unit: "cm" }, 4.20001), "4.2\u00a0cm");
  assert.equal(value_text(switch_of(0, 1), true), "on");
  assert.equal(value_text(lamp, { on: true, brightness: 128 }), "50%");
  assert.equal(value_text(lamp, { on: false }), "off");
});

test("RawOfAnInvertedSwitch_IsTurned", () => {
  assert.equal(raw_of(switch_of(1, 0), true), 0);
  assert.equal(raw_of(lamp, { on: true, brightness: 255 }), 255);
  assert.equal(raw_of({ ...lamp, choices: [["off", 1], ["on", 0]] }, { on: true }), 0);
  assert.deepEqual(range_of(angle(0)), { min: 0, max: 180, step: 1 });
  assert.equal(range_of(switch_of(0, 1)), undefined);
});
