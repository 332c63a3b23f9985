// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import fs from "node:fs";
import test from "node:test";
import { set_text } from "../../../gateway/page/core/form.js";
import { pins_of, PinValues } from "../../../gateway/page/core/pins.js";

const model = (name) => JSON.parse(fs.readFileSync(new URL(`../../../services/${name}.json`, import.meta.url)));
const pins = pins_of({ pins: { capabilities: "5555", owners: "IIII", modes: "3355" }, services: [{ name: "io", id: "I" }] });

test("WhatWasSet_IsInWords", () => {
  assert.equal(set_text({ write: { 10: 45, 0: 90 } }, model("servo"), "write"), "0: 90 degrees, 10: 45 degrees");
  assert.equal(set_text({ write: { 13: 1 } }, model("io"), "write"), "13: high");
  assert.equal(set_text({ report: 100 }, model("io"), "report"), "100 ms");
  assert.equal(set_text({ play: { frequency: 440, duration: 20 } }, model("tone"), "play"), "frequency 440 Hz duration 20 ms");
  assert.equal(set_text({ stop: { 0: true } }, model("motors"), "stop"), "0");
  assert.equal(set_text({ remap: [9, 10] }, model("servo"), "remap"), "[9,10]");
});

test("NothingKnownOrNoModel_IsNothingOrAsItCame", () => {
  assert.equal(set_text(null, model("servo"), "write"), "");
  assert.equal(set_text({}, model("servo"), "write"), "");
  assert.equal(set_text({ write: { 0: 90 } }, undefined, "write"), "0: 90");
});

test("Pins_ShowWhatOthersSet_AndForgetIt", () => {
  const values = new PinValues();
  values.executed("write", { pin: 0, level: 1 });
  values.set_is({ write: { 1: 1 }, pwm: { 2: 255 } });
  assert.deepEqual(pins.map((pin) => values.state_of(pin).text), ["", "high", "100%", ""]);
  assert.equal(values.state_of(pins[1]).told, true);
  values.set_is(null);
  assert.deepEqual(pins.map((pin) => values.state_of(pin).text), ["", "", "", ""]);
});

test("What others publish as set does no harm", () => {
  const values = new PinValues();
  for (const set of [7, "x", [], { write: 7 }, { write: { x: 1, 300: 1 }, pwm: null, mode: "out" }]) values.set_is(set);
  assert.deepEqual(pins.map((pin) => values.state_of(pin).text), ["", "", "", ""]);
});
