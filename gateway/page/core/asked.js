// SPDX-License-Identifier: Apache-2.0
// What was asked of a board, in the words of the service's model: no screen but "Advanced" shows the wire.
import { button_text } from "./form.js";
import { t } from "./language.js";
import { argument_word, choice_word, service_text, with_unit, word_text, words } from "./text.js";

/// The model of a service: that of its name, also where a board has several ("servo2"). Undefined: it is not known.
export const model_name = (service, names) => [service, service.replace(/-?\d+$/, "")].find((each) => names.includes(each));

/// {model, name, args} of a request as JSON or as text, as far as they are known; `models`: those that are, by name.
function read(request, service, models) {
  const own = service ? models.get(model_name(service, [...models.keys()])) : undefined;
  try {
    const [[name, args]] = Object.entries(JSON.parse(request)); // throws where it is no object
    return { model: own, name, args };
  } catch {
    const [first, ...rest] = String(request ?? "").split(",");
    const model = own ?? (service ? undefined : [...models.values()].find((each) => each.id === first));
    const [tag, ...args] = own ? [first, ...rest] : rest;
    const name = Object.keys(model?.commands ?? {}).find((each) => model.commands[each].tag === tag);
    return { model, name, args: name && args.map((each) => (each.trim() === "" || Number.isNaN(Number(each)) ? each : Number(each))) };
  }
}

/// [argument, value] of those that one word says; undefined where there are others.
function pairs_of(command, args) {
  const list = Array.isArray(args) ? args : args === true || args === null || args === undefined ? [] : [args];
  const named = args !== null && typeof args === "object" && !Array.isArray(args);
  const pairs = (command.args ?? []).map((each, i) => [each, named ? args[each.name] : list[i]]);
  return pairs.some(([each, value]) => each.type === "list" || each.type === "count" || typeof value === "object") ? undefined : pairs.filter(([, value]) => value !== undefined);
}

/// "angle 90°", of one that has a word only that: "output".
function pair_text([argument, value], alone) {
  const called = Object.entries(argument.names ?? {}).find(([name, number]) => number === value || name === value)?.[0];
  if (called) return choice_word(called);
  return alone ? with_unit(value, argument.unit) : `${argument_word(argument.name)} ${with_unit(value, argument.unit)}`;
}

const on_off = { low: t("off"), high: t("on"), off: t("off") };

/// "Servo 0 to 45°", "Pin 13 on", where a command sets one number of one element; undefined of others. `pins`: what they are called.
function set_text(model, pairs, chosen, pins) {
  const [argument, value] = pairs?.length === 2 && chosen !== undefined ? pairs.find(([each]) => each.name !== model.element) : [];
  if (typeof value !== "number") return undefined;
  const called = Object.entries(argument.names ?? {}).find(([, number]) => number === value)?.[0];
  const what = (model.name === "io" && pins[chosen]) || `${model.name === "io" ? t("pin") : words(model.element)} ${chosen}`;
  if (called) return on_off[called] && `${what} ${on_off[called]}`;
  return t("to-value", { what, value: with_unit(value, argument.unit) });
}

function model_text(model, name, args, pins) {
  const command = model.commands[name];
  const pairs = pairs_of(command, args);
  const chosen = pairs?.find(([argument]) => argument.name === model.element)?.[1];
  const set = set_text(model, pairs, chosen, pins);
  if (set) return set;
  const title = button_text(command, name, model.element, chosen === undefined ? undefined : String(chosen));
  const rest = (pairs ?? []).filter(([argument]) => argument.name !== model.element || !title.split(" ").includes(String(chosen)));
  const told = rest.map((each) => pair_text(each, rest.length === 1 && each[0].name !== model.element)).join(", ");
  const of = `${title} ${told}`.toLowerCase().includes(word_text(model.element ?? model.name).toLowerCase()) ? "" : ` (${service_text(model.name)})`;
  return [title + of, pairs ? told : "…"].filter(Boolean).join(": ");
}

/// "Servo 0 to 90°" for {"write":[0,90]} and for "W,0,90".
export function asked_text(request, service = "", models = new Map(), pins = {}) {
  const { model, name, args } = read(request, service, models);
  if (!service && ["labels", "names", "meanings"].includes(name)) return t("names-and-labels");
  if (model?.commands?.[name]) return model_text(model, name, args, pins);
  if (!name) return t("raw-request");
  const values = (Array.isArray(args) ? args : args === true || args === null ? [] : typeof args === "object" ? Object.entries(args).map((each) => each.join(" ")) : [args]).map((each) => (typeof each === "object" ? "…" : each));
  return [`${service && `${service_text(service)}, `}${words(name).toLowerCase()}`, values.join(", ")].filter((each) => each !== "").join(" ");
}
