// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import test from "node:test";
import { answer_text, arguments_of, button_text, command_order, fields_of, hint_of, place_of, safe_form } from "../../../gateway/page/core/form.js";

const folder = new URL("../../../services/", import.meta.url);
const model = (name) => JSON.parse(readFileSync(new URL(`${name}.json`, folder)));
const form = (name, command, service) => fields_of(model(name).commands[command], model(name), service);

test("Servo_HasElementAndSliderWithRangeAndUnit", () => {
  const [servo, angle] = form("servo", "write", { elements: [0, 1] });
  assert.equal(servo.kind, "choice");
  assert.deepEqual(servo.choices.map((choice) => choice.name), ["servo 0", "servo 1"]);
  assert.equal(servo.preset, 0);
  assert.equal(angle.slider, true);
  assert.equal(hint_of(angle), "0 to 180");
  assert.equal(angle.unit, "degrees");
});

test("NumberOfElementsNotKnown_AsksForANumberAndSuggestsTheFirst", () => {
  const [servo] = form("servo", "write", {});
  assert.deepEqual([servo.kind, servo.preset, servo.slider], ["integer", 0, undefined]);
});

test("ServosThatTheBoardHasNot_AreNotOffered", () => {
  assert.deepEqual(form("servo", "write", { count: 9, elements: [0, 1] })[0].choices.map((choice) => choice.value), [0, 1]);
});

test("Button_SaysWhatItDoes", () => {
  const text = (name, command, chosen) => button_text(model(name).commands[command], command, model(name).element, chosen);
  assert.deepEqual([text("servo", "write", "2"), text("servo", "write"), text("motors", "stop", "0"), text("motors", "stop-all"), text("pixels", "brightness"), text("io", "report")],
    ["Turn servo 2", "Turn a servo", "Stop motor 0", "Stop every motor", "Set the brightness", "Report analog pins periodically"]);
});

test("Commands_BeginWithWhatMovesSomething", () => {
  assert.deepEqual(command_order(model("servo")), ["write", "remap"]);
  assert.deepEqual(command_order(model("distance")), ["measure", "report"]);
  assert.equal(command_order(model("pixels"))[0], "brightness");
});

test("AllNumbersHaveNames_IsAChoiceWithOneNameEach", () => {
  const [, mode] = form("io", "mode");
  assert.deepEqual(mode.choices.map(({ value }) => value), [0, 1, 2, 3, 4, 5]);
  const [, level] = form("io", "write");
  assert.deepEqual(level.choices, [{ value: 0, name: "low" }, { value: 1, name: "high" }]);
});

test("WideRange_HasNoSlider", () => {
  assert.equal(form("distance", "report")[0].slider, false);
});

test("Forms_StandWhereTheyAreLookedFor", () => {
  const places = (name) => Object.keys(model(name).commands).map((each) => `${each} ${place_of(model(name), each)}`);
  assert.deepEqual(places("servo"), ["write control", "remap advanced"]);
  assert.deepEqual(places("motors"), ["power advanced", "drive control", "stop control", "stop-all control"]);
  for (const sensor of ["distance", "humidity", "heading"]) for (const each of places(sensor)) assert.match(each, /advanced$/, sensor);
});

test("WhatMoves_SaysHold_AndWhatLightsDoesNot", () => {
  const held = readdirSync(folder).filter((name) => name.endsWith(".json") && name !== "schema.json").map((name) => name.slice(0, -5))
    .flatMap((name) => Object.entries(model(name).commands ?? {}).filter(([, each]) => each.hold).map(([each]) => `${name} ${each}`));
  assert.deepEqual(held, ["motors power", "motors drive"]);
});

test("CountOfAList_IsNotAsked", () => {
  assert.deepEqual(form("pixels", "set").map((field) => field.name), ["pixels"]);
});

test("EnteredValues_BecomeArgumentsByName", () => {
  const fields = form("servo", "write", { elements: [0, 1] });
  assert.deepEqual(arguments_of(fields, { servo: "1", angle: "90" }), { args: { servo: 1, angle: 90 } });
});

test("ValueMissingOutOfRangeOrNoNumber_SaysWhichAndWhy", () => {
  const fields = form("servo", "write", { elements: [0, 1] });
  assert.deepEqual(arguments_of(fields, { servo: "0", angle: "" }), { error: "angle is missing", field: "angle" });
  assert.equal(arguments_of(fields, { servo: "0", angle: "181" }).error, "angle is above 180");
  assert.equal(arguments_of(fields, { servo: "0", angle: "-1" }).error, "angle is below 0");
  assert.equal(arguments_of(fields, { servo: "0", angle: "1.5" }).error, "angle is not a whole number");
  assert.equal(arguments_of(fields, { servo: "0", angle: "up" }).error, "angle is not a number");
});

test("List_TakesRows", () => {
  const fields = form("pixels", "set", { elements: [0] });
  assert.deepEqual(arguments_of(fields, { pixels: [["3", "#ff0000"]] }), { args: { pixels: [{ pixel: 3, color: "#ff0000" }] } });
  assert.deepEqual(arguments_of(form("servo", "remap"), { pins: [["9"], ["10"]] }), { args: { pins: [9, 10] } });
  assert.equal(arguments_of(fields, { pixels: [] }).error, "pixels is empty");
  assert.equal(arguments_of(form("servo", "remap"), { pins: [["9"], ["300"]] }).error, "pins 2: pin is above 255");
});

test("Text_MustBePlainAndShort", () => {
  const fields = form("lcd", "write");
  assert.equal(arguments_of(fields, { line: "0", text: "x".repeat(22) }).error, "text is longer than 21 characters");
  assert.equal(arguments_of(fields, { line: "0", text: "süß" }).error, "text takes plain ASCII characters only");
});

test("EveryExampleOfEveryModel_CanBeEnteredInItsForm", () => {
  let entered_examples = 0;
  for (const file of readdirSync(folder).filter((name) => name.endsWith(".json") && name !== "schema.json")) {
    const each = model(file.replace(".json", ""));
    for (const { json, error, wire } of each.examples) {
      const [[name, args]] = Object.entries(json);
      if (error || wire.startsWith("@")) continue;
      const fields = fields_of(each.commands[name], each);
      const entered = entered_as(fields, args);
      if (!entered) continue;
      ++entered_examples;
      assert.equal(arguments_of(fields, entered).error, undefined, `${file}: ${JSON.stringify(json)}`);
    }
  }
  assert.ok(entered_examples > 25, `${entered_examples}`);
});

// What a person would enter for the arguments of an example. Undefined: items as on the wire, which have no form.
function entered_as(fields, args) {
  if (JSON.stringify(args).includes(":2")) return undefined;
  if (args === null || args === true) args = [];
  if (typeof args !== "object") args = [args];
  const list = fields.at(-1)?.kind === "list";
  if (Array.isArray(args) && list && fields.length === 1) args = [args]; // the items themselves
  const values = Array.isArray(args) ? Object.fromEntries(fields.map(({ name }, i) => [name, args[i]])) : args;
  return Object.fromEntries(fields.map(({ name, kind }) => [name, kind === "list" ? values[name].map(rows_of) : String(Number(values[name]) || values[name])]));
}

function rows_of(item) { return (typeof item === "object" ? Object.values(item) : [item]).map(String); }

test("SafeFormByName_TakesItsArgumentsByName", () => {
  assert.deepEqual(safe_form(model("motors"), "power", { motor: 1, power: 80 }), { command: "stop", args: { motor: 1 } });
});

test("SafeFormByValues_KeepsWhatIsNull", () => {
  assert.deepEqual(safe_form(model("motors"), "drive", { power0: 5, power1: 6 }), { command: "drive", args: { power0: 0, power1: 0 } });
  assert.deepEqual(safe_form(model("io"), "write", { pin: 13, level: 1 }), { command: "write", args: { pin: 13, level: 0 } });
});

test("NoSafeForm_IsUndefined", () => {
  assert.equal(safe_form(model("servo"), "write", { servo: 0, angle: 9 }), undefined);
});

test("EveryAnswer_IsSaidInWords", () => {
  assert.deepEqual(answer_text({ status: "ok", proof: "fence" }), { kind: "ok", text: "Done: the board has executed it." });
  assert.deepEqual(answer_text({ status: "ok", proof: "answer", answer: { distance: [42, 118] } }), { kind: "ok", text: "Answer: 42, 118" });
  assert.deepEqual(answer_text({ status: "error", code: 7, error: "INVALID_DEVICE_NUMBER" }), { kind: "error", text: "The board's error 7: invalid device number." });
  assert.deepEqual(answer_text({ status: "refused", reason: "queue-full", error: "64 commands wait" }), { kind: "refused", text: "Not sent: 64 commands wait" });
  assert.deepEqual(answer_text({ status: "refused", reason: "stopped", error: "the board is stopped by loopback since 2026-11-01T10:00:00Z" }), { kind: "refused", text: "Not sent: the board was stopped" });
  assert.match(answer_text({ status: "timeout", reason: "connection" }).text, /may or may not/);
  const words = "the board gave no proof in time; it may or may not have been executed";
  assert.deepEqual(answer_text({ status: "timeout", error: words }), { kind: "timeout", text: "The board gave no proof in time; it may or may not have been executed." });
});
