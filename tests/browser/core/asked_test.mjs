// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { asked_text } from "../../../gateway/page/core/asked.js";

const models = new Map(["io", "servo", "distance", "motors", "tone", "lcd", "pixels"].map((name) => [name, JSON.parse(readFileSync(new URL(`../../../services/${name}.json`, import.meta.url)))]));
const told = (request, service) => asked_text(request, service, models);

test("JSON and a line of text that ask the same are told the same", () => {
  for (const request of ['{"write":[0,90]}', '{"write":{"servo":0,"angle":90}}', "W,0,90"]) assert.equal(told(request, "servo"), "Servo 0 to 90°");
  for (const request of ['{"mode":[13,3]}', "P,13,3"]) assert.equal(told(request, "io"), "Set the mode of pin 13: output");
  assert.equal(told("I,d,13,1"), "Pin 13 on"); // a raw line
  assert.equal(asked_text("I,d,13,0", "", models, { 13: "LED" }), "LED off");
  assert.equal(told('{"pwm":[9,128]}', "io"), "Pin 9 to 128");
});

test("a service says what it is where its command does not", () => {
  assert.equal(told("M", "distance"), "Measure once (Distance)");
  assert.equal(told('{"report":50}', "distance"), "Report periodically (Distance): 50\u00a0ms");
  assert.equal(told('{"stop-all":true}', "motors"), "Stop every motor");
  assert.equal(told("P,440,500", "tone"), "Play a tone: frequency 440\u00a0Hz, duration 500\u00a0ms");
});

test("the second one of a kind has the words of the first", () => {
  assert.equal(told("W,0,90", "servo2"), "Servo 0 to 90°");
});

test("what is long is named only", () => {
  assert.match(told('{"set":[[{"pixel":3,"color":"#ff0000"}]]}', "pixels"), /^Set (single pixels|.*): …$/);
});

test("what no model describes is JSON in words, and no line of the wire", () => {
  assert.equal(told('{"open":[2]}', "gate"), "Gate, open 2");
  assert.equal(told('{"stop-all":true}', "gate"), "Gate, stop all");
  for (const odd of ["{", "7", "null", "{}", "W,0,90", "", "?"]) assert.equal(told(odd, "gate"), "a raw request", odd);
  for (const odd of ["Z,1", "I", "I,?,1"]) assert.equal(told(odd), "a raw request", odd);
  assert.equal(told('{"labels":{"room":"lab"}}'), "names and labels");
});
