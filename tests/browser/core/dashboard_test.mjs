// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { is_on, moved, name_of_title, offers_of, pin_offers, title_of, trouble_of, value_text } from "../../../gateway/page/core/dashboard.js";

const model = (name) => JSON.parse(readFileSync(new URL(`../../../services/${name}.json`, import.meta.url)));
const texts = (offers) => offers.map((offer) => offer.text);

test("A title becomes a name that a dashboard may have", () => {
  assert.equal(name_of_title(" Green house! "), "green-house");
  assert.equal(name_of_title("..."), "");
  assert.equal(name_of_title("Out"), "out-1");
  assert.equal(name_of_title("x".repeat(99)).length, 64);
});

test("A sensor offers value, plot and lamp of each element, also before it has said something", () => {
  const service = { name: "distance", count: 2 };
  const offers = offers_of("desk", service, model("distance"), undefined);
  assert.deepEqual(texts(offers).slice(0, 3).map((text) => text.split(": ")[1]), ["value", "plot", "lamp"]);
  assert.equal(offers.length, 6);
  assert.deepEqual(offers.map((offer) => offer.widget.key), ["0", "0", "0", "1", "1", "1"]);
  const said = offers_of("desk", service, model("distance"), { events: { distance: { value: [42] } } });
  assert.equal(said.length, 3);
  assert.equal(said[0].widget.unit, "cm");
});

test("A servo offers a slider for each element, and settings offer nothing", () => {
  const offers = offers_of("desk", { name: "servo", count: 2 }, model("servo"), undefined);
  assert.deepEqual(offers.map((offer) => [offer.widget.kind, offer.widget.args]), [["slider", { servo: 0 }], ["slider", { servo: 1 }]]);
  assert.deepEqual(offers_of("old", { name: "servo" }, model("servo"), undefined).map((offer) => offer.widget.args), [{ servo: 0 }], "a board that does not say how many");
  assert.deepEqual([offers[0].widget.min, offers[0].widget.max, offers[0].widget.argument], [0, 180, "angle"]);
});

test("What runs only while it is held is not offered", () => {
  assert.deepEqual(offers_of("robot", { name: "motors", count: 2 }, model("motors"), undefined), []);
});

test("A pin offers what its mode allows", () => {
  const pin = { number: 13, label: "13", name: "", channel: undefined };
  assert.deepEqual(texts(pin_offers("desk", pin, "output")), ["Pin 13: switch", "Pin 13: lamp"]);
  assert.deepEqual(pin_offers("desk", pin, "pwm")[0].widget.args, { pin: 13 });
  assert.equal(pin_offers("desk", { ...pin, name: "button" }, "input-pullup")[0].text, "button: lamp");
  assert.deepEqual(pin_offers("desk", pin, "unallocated"), []);
  assert.equal(pin_offers("desk", { ...pin, channel: 0 }, "analog")[1].widget.key, "0");
});

test("Widgets are moved within the list", () => {
  const list = ["a", "b", "c"].map((id) => ({ id }));
  assert.deepEqual(moved(list, "c", -1).map((each) => each.id), ["a", "c", "b"]);
  assert.equal(moved(list, "a", -1), list);
  assert.equal(moved(list, "x", 1), list);
});

test("What is not known is not shown as off", () => {
  assert.equal(is_on({}, undefined), undefined);
  assert.equal(is_on({}, 0), false);
  assert.equal(is_on({ on: 5, off: 2 }, 2), false);
  assert.equal(is_on({ on: 5, off: 2 }, 5), true);
  assert.equal(is_on({}, 17), true);
  assert.equal(value_text({ unit: "cm" }, undefined), "–");
  assert.equal(value_text({ unit: "cm" }, 4.20001), "4.2\u00a0cm");
});

test("A board that is gone is named", () => {
  const widget = { kind: "value", board: "attic" };
  assert.match(trouble_of(widget, { state: "unknown" }), /attic is not known/);
  assert.match(trouble_of(widget, { state: "lost" }), /attic is lost/);
  assert.equal(trouble_of(widget, { state: "online" }), "");
  assert.equal(trouble_of({ kind: "stop" }, undefined), "");
  assert.equal(title_of({ kind: "value", board: "a", service: "b", event: "c", key: "0" }), "a b 0");
});
