// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { moved, name_of_title, offers_of, selectors_of, title_of, trouble_of } from "../../../gateway/page/core/dashboard.js";

const texts = (offers) => offers.map((offer) => offer.text);

test("A title becomes a name that a dashboard may have", () => {
  assert.equal(name_of_title(" Green house! "), "green-house");
  assert.equal(name_of_title("..."), "");
  assert.equal(name_of_title("Out"), "out-1");
  assert.equal(name_of_title("x".repeat(99)).length, 64);
});

const property = (id, more) => ({ id, name: id, service: id.split("/")[0], kind: "sensor", type: "integer", access: "read", ...more });

test("Properties offer what their kind can do", () => {
  assert.deepEqual(texts(offers_of("desk", [property("distance/0", { unit: "cm" })])), ["distance/0 (cm): value", "distance/0 (cm): plot", "distance/0 (cm): lamp"]);
  const set = { access: "both", write: ["write", 0, null] };
  const offers = offers_of("desk", [property("servo/0/angle", { kind: "number", min: 0, max: 180, ...set }), property("io/13", { kind: "switch", type: "boolean", choices: [["off", 0], ["on", 1]], ...set })]);
  assert.deepEqual(offers.map((offer) => offer.widget.kind), ["slider", "value", "switch", "lamp"]);
  assert.deepEqual(offers[0].widget, { kind: "slider", board: "desk", property: "servo/0/angle" });
  assert.deepEqual(texts(offers_of("desk", [property("io/5", { kind: "light", max: 255, ...set })])).map((text) => text.split(": ")[1]), ["switch", "slider", "lamp"]);
  assert.deepEqual(texts(offers_of("desk", [property("io/6", { kind: "light", max: 1, choices: [["off", 0], ["on", 1]], ...set })])).map((text) => text.split(": ")[1]), ["switch", "lamp"]);
});

test("What has bounds can be a gauge", () => {
  assert.deepEqual(texts(offers_of("desk", [property("humidity/0", { min: 0, max: 100 })])).map((text) => text.split(": ")[1]), ["value", "plot", "gauge", "lamp"]);
});

test("Labels of boards choose them, as a selector says it", () => {
  const rows = [{ tags: { class: "4b", name: "Ann's" } }, { tags: { class: "4b", camera: "", owner: "Smith, Ann" } }, { tags: { odd: 'a"b' } }];
  assert.deepEqual(selectors_of(rows), ["camera", "class=4b", 'owner="Smith, Ann"']);
});

test("What moves is shown, and not set", () => {
  assert.deepEqual(texts(offers_of("robot", [property("motors/0/power", { kind: "number", min: -255, max: 255, access: "both", advanced: true })])), ["motors/0/power: value"]);
});

test("Widgets are moved within the list", () => {
  const list = ["a", "b", "c"].map((id) => ({ id }));
  assert.deepEqual(moved(list, "c", -1).map((each) => each.id), ["a", "c", "b"]);
  assert.equal(moved(list, "a", -1), list);
  assert.equal(moved(list, "x", 1), list);
});

test("A board that is gone is named", () => {
  const widget = { kind: "value", board: "attic" };
  assert.match(trouble_of(widget, { state: "unknown" }), /attic is not known/);
  assert.match(trouble_of(widget, { state: "lost" }), /attic is lost/);
  assert.equal(trouble_of(widget, { state: "online" }), "");
  assert.equal(trouble_of({ kind: "stop" }, undefined), "");
  assert.match(trouble_of({ ...widget, property: "io/2" }, { state: "online" }, null), /attic has no pin 2 now/);
  const refused = { refused: "a command made pin 2 an input" };
  assert.match(trouble_of({ kind: "switch", board: "attic" }, { state: "online" }, refused), /cannot be set: a command made pin 2 an input/);
  assert.equal(trouble_of(widget, { state: "online" }, refused), "", "what is read is read");
  assert.equal(title_of({ kind: "value", board: "a", property: "b/0" }), "a b 0");
  assert.equal(title_of({ kind: "value", board: "a", property: "b/0" }, { name: "Front" }), "Front");
});
