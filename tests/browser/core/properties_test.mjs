// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { elements_of, is_on, is_simple, place_in, range_of, value_text } from "../../../gateway/page/core/properties.js";

const switch_of = (off, on) => ({ id: "io/13", service: "io", kind: "switch", choices: [["off", off], ["on", on]], write: ["write", 13, null] });
const angle = (n) => ({ id: `servo/${n}/angle`, service: "servo", kind: "number", type: "integer", min: 0, max: 180, unit: "degrees", write: ["write", n, null] });
const lamp = { id: "io/5", service: "io", kind: "light", max: 255, write: ["pwm", 5, null] };

test("Elements_AreThoseThatTheBoardHas", () => {
  assert.deepEqual(elements_of([angle(1), angle(0), { id: "servo/stop", service: "servo" }]), [0, 1]);
  assert.deepEqual(elements_of([{ id: "distance/7", service: "distance" }]), [7]);
  assert.deepEqual(elements_of([{ id: "humidity", service: "humidity" }]), []);
});

test("NotKnown_IsNeitherOffNorZero", () => {
  assert.equal(is_on(undefined), undefined);
  assert.equal(is_on(null), undefined);
  assert.equal(is_on(0), false);
  assert.equal(is_on({ on: true }), true);
  assert.equal(place_in(undefined), undefined);
  assert.equal(place_in({ on: false }), 0);
  assert.equal(value_text(angle(0), undefined), "");
  assert.equal(value_text(angle(0), null), "none");
});

test("Values_AreInWords", () => {
  assert.equal(value_text({ unit: "cm" }, 4.20001), "4.2\u00a0cm");
  assert.equal(value_text(switch_of(0, 1), true), "on");
  assert.equal(value_text(lamp, { on: true, brightness: 128 }), "50%");
  assert.equal(value_text(lamp, { on: false }), "off");
  const of_class = (name) => ({ ...switch_of(1, 0), kind: "binary", meaning: { class: name } });
  assert.deepEqual(["button", "door", "moisture", "motion", "fan"].flatMap((name) => [true, false].map((on) => value_text(of_class(name), on))),
    ["pressed", "released", "open", "closed", "wet", "dry", "detected", "clear", "on", "off"]);
  assert.equal(value_text(of_class("button"), true, [[7, "press"], [8, "hold"]]), "pressed, hold");
  assert.equal(value_text(of_class("button"), false, [[8, "hold"], [9, "release"]]), "released");
});

test("OneControlSaysAll_OfSwitchesLampsAndNumbersOfFewSteps", () => {
  assert.deepEqual(range_of(angle(0)), { min: 0, max: 180, step: 1 });
  assert.equal(range_of(switch_of(0, 1)), undefined);
  assert.deepEqual([angle(0), switch_of(0, 1), lamp].map(is_simple), [true, true, true]);
  assert.deepEqual([{ kind: "number", type: "integer", min: 0, max: 65535 }, { kind: "text" }, { kind: "light", color: {} }].map(is_simple), [false, false, false]);
});
