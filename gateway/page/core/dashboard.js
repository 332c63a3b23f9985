// SPDX-License-Identifier: Apache-2.0
// What can stand on a dashboard, and what a widget shows. A widget is as the gateway keeps it: {id, kind, title, board, ...}.
import { fields_of, place_of } from "./form.js";
import { mode_names, pins_of } from "./pins.js";
import { numbers_of } from "./series.js";
import { unit_text, with_unit, words } from "./text.js";

export const kSizes = ["small", "wide", "large"];
const kMaxElements = 8;  // of one command, that are offered
const kMaxOffers = 60;
const kDigits = 4;

/// A name for a new dashboard of what a person typed: "Green house!" is "green-house"; "" where nothing is left.
export function name_of_title(title) {
  const name = title.trim().toLowerCase().replace(/[^a-z0-9._-]+/g, "-").replace(/^[-.]+|[-.]+$/g, "").slice(0, 64);
  return ["in", "out", "error", "set"].includes(name) ? `${name}-1` : name;
}

// Values of a service that has said nothing yet, as its model says that they will be.
function expected_value(event, model, count) {
  const one = event.fields?.length > 1 ? Object.fromEntries(event.fields.map((field) => [field.name, 0])) : 0;
  return model.element ? Array.from({ length: Math.min(count || 1, kMaxElements) }, () => one) : one;
}

function reading_offers(base, name, value, event, model) {
  return numbers_of(name, value, event, model?.element).flatMap((number) => {
    const scalar = typeof value !== "object";
    const widget = { ...base, event: name, key: scalar ? "" : number.key, ...(number.unit ? { unit: number.unit } : {}) };
    const title = words(Array.isArray(value) && value.length > 1 ? `${name} ${number.key.replace(".", " ")}` : number.name || name);
    const text = [title, number.unit && `(${unit_text(number.unit)})`].filter(Boolean).join(" ");
    return [{ text: `${text}: value`, widget: { kind: "value", title, ...widget } },
      { text: `${text}: plot`, widget: { kind: "plot", title, size: "wide", ...widget } },
      { text: `${text}: lamp`, widget: { kind: "lamp", title, ...widget } }];
  });
}

// One widget sets one argument; the others stay. Of what runs only while it is held there is none.
function command_offers(base, name, model, service) {
  const command = model.commands[name];
  if (command.hold || place_of(model, name) !== "control") return [];
  const fields = fields_of(command, model, service);
  const element = fields.find((field) => field.name === model.element);
  const varying = fields.filter((field) => field !== element);
  if (varying.length !== 1 || (element && !element.choices && element.preset === undefined)) return [];
  const [field] = varying;
  const elements = element ? element.choices?.slice(0, kMaxElements) ?? [{ value: element.preset, name: "" }] : [undefined]; // how many there are may not be known
  return elements.flatMap((each) => {
    const args = each ? { [element.name]: each.value } : {};
    const title = [command.title ?? words(name), each && elements.length > 1 ? each.name : ""].filter(Boolean).join(", ");
    const widget = { title, ...base, command: name, args, argument: field.name, ...(field.unit ? { unit: field.unit } : {}) };
    const lamp = { text: `${title}: lamp`, widget: { kind: "lamp", ...widget } };
    if (field.kind === "choice" && field.choices.length === 2) {
      const [off, on] = field.choices.map((choice) => choice.value);
      return [{ text: `${title}: switch`, widget: { kind: "switch", ...widget, on, off } }, { text: lamp.text, widget: { ...lamp.widget, on, off } }];
    }
    if (!field.slider) return [];
    return [{ text: `${title}: slider`, widget: { kind: "slider", ...widget, min: field.min, max: field.max, ...(field.kind === "integer" ? { step: 1 } : {}) } }];
  });
}

/// What of a service can stand on a dashboard: [{text, widget}]. `value`: as the gateway gives its last values, or undefined.
export function offers_of(board, service, model, value) {
  const base = { board, service: service.name };
  const events = new Map(Object.values(model?.events ?? {}).map((event) => [event.name, event]));
  const names = new Set([...events.keys(), ...Object.keys(value?.events ?? {})]);
  names.delete("error");
  const readings = [...names].flatMap((name) => {
    const last = value?.events?.[name]?.value ?? (events.has(name) ? expected_value(events.get(name), model, service.count) : undefined);
    return reading_offers(base, name, last, events.get(name), model);
  });
  const commands = Object.keys(model?.commands ?? {}).flatMap((name) => command_offers(base, name, model, service));
  return [...commands, ...readings].slice(0, kMaxOffers);
}

/// The same of one pin in its mode.
export function pin_offers(board, pin, mode) {
  const base = { board, service: "io" };
  const title = pin.name || `Pin ${pin.label}`;
  if (mode === "output") {
    const widget = { title, ...base, command: "write", args: { pin: pin.number }, argument: "level", on: 1, off: 0 };
    return [{ text: `${title}: switch`, widget: { kind: "switch", ...widget } }, { text: `${title}: lamp`, widget: { kind: "lamp", ...widget } }];
  }
  if (mode === "pwm") return [{ text: `${title}: slider`, widget: { kind: "slider", title, ...base, command: "pwm", args: { pin: pin.number }, argument: "duty", min: 0, max: 255, step: 1 } }];
  if (mode === "analog") {
    const widget = { title, ...base, event: "analog", key: String(pin.channel) };
    return [{ text: `${title}: value`, widget: { kind: "value", ...widget } }, { text: `${title}: plot`, widget: { kind: "plot", size: "wide", ...widget } }];
  }
  if (mode !== "input" && mode !== "input-pullup") return [];
  const widget = { title, ...base, event: "digital", key: String(pin.number) };
  return [{ text: `${title}: lamp`, widget: { kind: "lamp", ...widget } }, { text: `${title}: value`, widget: { kind: "value", ...widget } }];
}

/// Of all free pins of a board, as its description and its agent say; `set`: what was set in its service of pins.
export function all_pin_offers(board, description, set) {
  return pins_of(description).filter((pin) => pin.owner === "")
    .flatMap((pin) => pin_offers(board, pin, mode_names[set?.mode?.[pin.number] ?? pin.mode]));
}

/// The document with one widget moved by `step` places.
export function moved(widgets, id, step) {
  const from = widgets.findIndex((each) => each.id === id);
  const to = from + step;
  if (from < 0 || to < 0 || to >= widgets.length) return widgets;
  const result = widgets.slice();
  result.splice(to, 0, ...result.splice(from, 1));
  return result;
}

export function title_of(widget) {
  if (widget.title) return widget.title;
  if (widget.kind === "stop") return "Stop";
  return [widget.board, widget.service, widget.key || widget.event || widget.command].filter(Boolean).join(" ");
}

/// What a value widget says.
export function value_text(widget, value) {
  if (value === undefined || value === null) return "–";
  if (typeof value === "number") return with_unit(Number(value.toFixed(kDigits)), widget.unit);
  return typeof value === "string" ? value : JSON.stringify(value);
}

/// Whether a switch or a lamp is on: true, false, or undefined where it is not known.
export function is_on(widget, value) {
  if (value === undefined || value === null) return undefined;
  const { on = 1, off = 0 } = widget;
  if (value === on) return true;
  return value === off ? false : Boolean(value);
}

/// Why a widget can do nothing now; "" where it can. `board`: {state, reason} as the stream says.
export function trouble_of(widget, board) {
  if (widget.kind === "stop") return "";
  if (!board) return "Waiting for the bus …";
  if (board.state === "unknown") return `Board ${widget.board} is not known. It may have been forgotten.`;
  if (board.state === "lost" || board.state === "offline") return `Board ${widget.board} is ${board.state}.`;
  return board.state === "updating" ? `Board ${widget.board}: its port is in other hands.` : "";
}
