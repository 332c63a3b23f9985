// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { board_rows, pins_of, PinValues, settable_modes } from "../../../gateway/page/core/pins.js";

const uno = {
  pins: { capabilities: "11151511155511333333", owners: "@@IIIII-ISIIIIIIIIII", modes: "66111111171111444444", analog: { 14: 0, 15: 1, 16: 2, 17: 3, 18: 4, 19: 5 } },
  services: [{ name: "io", id: "I" }, { name: "servo", id: "S" }],
};
const mega = { pins: { capabilities: "1".repeat(54) + "3".repeat(16), owners: "I".repeat(70), modes: "1".repeat(70), analog: Object.fromEntries(Array.from({ length: 16 }, (_, i) => [54 + i, i])) }, services: [] };

test("Description_SaysOwnerLabelAndMode", () => {
  const pins = pins_of(uno);
  assert.equal(pins.length, 20);
  assert.deepEqual([pins[0].owner, pins[2].owner, pins[7].owner, pins[9].owner], ["system", "", "", "servo"]);
  assert.deepEqual([pins[13].label, pins[14].label, pins[19].label], ["13", "A0", "A5"]);
  assert.equal(pins[14].channel, 0);
});

test("NameOfAPin_IsWithIt", () => {
  const pins = pins_of({ ...uno, names: { pins: { 13: "status lamp" } } });
  assert.deepEqual([pins[13].name, pins[13].label, pins[12].name], ["status lamp", "13", ""]);
});

test("NoPinsInDescription_IsEmpty", () => {
  assert.deepEqual(pins_of({ services: [] }), []);
  assert.deepEqual(pins_of(undefined), []);
});

test("UnoRows_AreAsOnTheBoard", () => {
  const rows = board_rows(pins_of(uno)).map((row) => row.map((group) => group.map((pin) => pin.label).join(" ")));
  assert.deepEqual(rows, [["13 12 11 10 9 8", "7 6 5 4 3 2 1 0"], ["A0 A1 A2 A3 A4 A5"]]);
});

test("MegaRows_HoldEachPinOnce", () => {
  const all = board_rows(pins_of(mega)).flat(2).map((pin) => pin.number);
  assert.equal(all.length, 70);
  assert.equal(new Set(all).size, 70);
});

test("Modes_FollowFromWhatThePinCanDo", () => {
  assert.deepEqual(settable_modes({ can: 1 }), ["input", "input-pullup", "output"]);
  assert.deepEqual(settable_modes({ can: 5 }), ["input", "input-pullup", "output", "pwm"]);
  assert.deepEqual(settable_modes({ can: 2 }), ["analog"]);
  assert.deepEqual(settable_modes({ can: 0 }), []);
});

const output = { id: "io/13", kind: "switch", choices: [["off", 0], ["on", 1]] };

test("ModeThatACommandSet_CountsMoreThanThatOfTheBoard", () => {
  const pins = pins_of({ ...uno, pin_modes: { 13: 3 } });
  assert.deepEqual(new PinValues().state_of(pins[13]), { mode: "output", text: "", level: undefined, told: false });
});

test("Properties_SayHowOutputsStand_AndMeaningsTurnInputs", () => {
  const pins = pins_of(uno);
  const values = new PinValues();
  values.stands([output, { id: "io/2", kind: "binary" }, { id: "io/10", kind: "number", max: 255 }, { id: "servo/0/angle" }],
    new Map([["io/13", { value: true, how: "set" }], ["io/2", { value: true, how: "reported" }], ["io/10", { value: 51, how: "set" }]]));
  assert.deepEqual([values.state_of(pins[13]).text, values.state_of(pins[13]).told], ["on", true]);
  assert.deepEqual([values.state_of(pins[2]).text, values.state_of(pins[2]).told], ["on", false]);
  assert.deepEqual([values.state_of(pins[10]).text, values.state_of(pins[10]).level], ["51", 0.2]);
  values.stands([{ id: "io/2", kind: "binary", meaning: { class: "button" } }, { id: "io/10", kind: "sensor" }],
    new Map([["io/2", { value: true, how: "reported", events: [[1, "press"], [2, "double"]] }], ["io/10", { value: null, how: "reported" }]]));
  assert.equal(values.state_of(pins[2]).text, "pressed, double");
  assert.equal(values.state_of(pins[10]).text, "none");
  values.stands([output], new Map([["io/13", { unknown: "restart" }]]));
  assert.equal(values.state_of(pins[13]).text, "");
  assert.deepEqual(values.state_of(pins[2]), { mode: "input", text: "", level: undefined, told: false }, "what nobody uses floats, and says nothing");
});
