// SPDX-License-Identifier: Apache-2.0
// Forms for commands, made from the service model.
import { known_text, locale, t } from "./language.js";
import { argument_word, first_up, title_text, words } from "./text.js";

const kMaxSliderSteps = 1023;

function choices_of(argument) {
  const entries = Object.entries(argument.names ?? {});
  const { min, max } = argument;
  if (entries.length === 0 || min === undefined || max === undefined) return undefined;
  const by_number = new Map();
  for (const [name, number] of entries) if (!by_number.has(number)) by_number.set(number, name);
  if (by_number.size < max - min + 1) return undefined;
  return [...by_number].sort((a, b) => a[0] - b[0]).map(([value, name]) => ({ value, name }));
}

function field_of(argument, model, service) {
  const field = { name: argument.name, title: argument.title, unit: argument.unit, min: argument.min, max: argument.max,
    max_length: argument.max_length, names: argument.names };
  if (argument.type === "list") {
    return { ...field, kind: "list", items: argument.items.map((item) => field_of(item, model, service)) };
  }
  if (argument.type === "text" || argument.type === "color") return { ...field, kind: argument.type };
  if (argument.name === model.element && argument.type === "integer") {
    const first = model.name === "io" ? undefined : argument.min ?? 0; // no pin is the usual one
    if (!service.elements?.length || model.name === "io") return { ...field, kind: "integer", preset: first };
    const choices = service.elements.map((value) => ({ value, name: `${model.element} ${value}` }));
    return { ...field, kind: "choice", choices, preset: choices[0].value };
  }
  const choices = choices_of(argument);
  if (choices) return { ...field, kind: "choice", choices };
  const span = argument.max - argument.min;
  return { ...field, kind: argument.type, slider: span > 0 && (argument.type === "number" || span <= kMaxSliderSteps) };
}

/// The fields of a command's form. `service` may have `elements`: the numbers of those that the board has.
export function fields_of(command, model, service = {}) {
  return (command.args ?? []).filter((argument) => argument.type !== "count").map((argument) => field_of(argument, model, service));
}

/// What its button says: "Stop motor 0", "Set the brightness". `chosen`: the number of the `element` that it is about.
export function button_text(command, name, element, chosen) {
  const whole = command.title ?? words(name);
  const about = chosen && known_text(`do.${whole}`, { n: chosen });
  if (about) return about;
  if (title_text(whole) !== whole) return title_text(whole).split(/ ?[;,:(]/)[0];
  const title = whole.split(/[;,] /)[0];
  const told = chosen ? title.replace(new RegExp(`\\b(an?|one) ${element}\\b`), `${element} ${chosen}`) : title;
  return told.includes(`${element} ${chosen}`) || !command.args?.length ? told.split(" to ")[0] : told.split(/ (?:of|to|that) /)[0];
}

/// The names of the commands: first what moves something, then what asks, then settings.
export function command_order(model) {
  const rank = (name) => {
    const { args = [], safe, answer } = model.commands[name];
    if (safe !== undefined || fields_of(model.commands[name], model).some((field) => field.slider)) return 0;
    return answer && args.length === 0 ? 1 : 2;
  };
  return Object.keys(model.commands ?? {}).sort((a, b) => rank(a) - rank(b));
}

/// Where the form of a command stands: "control", or "advanced": periods of reports, questions for a value, rare settings.
export function place_of(model, name) {
  const { args = [], safe, answer, advanced } = model.commands[name];
  if (safe !== undefined && !advanced) return "control";
  return advanced || name === "report" || (answer && args.length === 0) ? "advanced" : "control";
}

function range_text(field) {
  if (field.min !== undefined && field.max !== undefined) return t("min-max", { min: field.min, max: field.max });
  if (field.min !== undefined) return t("min-or-more", { min: field.min });
  return field.max !== undefined ? t("max-or-less", { max: field.max }) : "";
}

/// What may be entered: "0 to 180", "up to 21 characters".
export function hint_of(field) {
  if (field.kind === "text") return field.max_length ? t("up-max", { max_length: field.max_length }) : "";
  if (field.kind === "list") return field.max_length ? t("up-max-length", { max_length: field.max_length }) : "";
  return range_text(field);
}

function parse_number(field, text) {
  const named = field.names?.[text.trim()];
  if (named !== undefined) return { value: named };
  const value = Number(text);
  if (!Number.isFinite(value)) return { error: t("not-number") };
  if (field.kind === "integer" && !Number.isInteger(value)) return { error: t("not-whole") };
  if (value < field.min) return { error: t("below-min", { min: field.min }) };
  if (value > field.max) return { error: t("above-max", { max: field.max }) };
  return { value };
}

/// What was entered as a value, or why it is not one: {value} or {error}.
export function parse_field(field, text) {
  if (field.kind === "list") return parse_list(field, text);
  if (field.kind === "text") {
    if (/[^\x20-\x7e]/.test(text)) return { error: t("takes-plain") };
    if (text.length > field.max_length) return { error: t("longer-than", { max_length: field.max_length }) };
    return { value: text };
  }
  if (text === undefined || String(text).trim() === "") return { error: t("field-missing") };
  if (field.kind === "color") return { value: text };
  return parse_number(field, String(text));
}

function parse_list(field, rows) {
  if (!rows?.length) return { error: t("field-empty") };
  if (rows.length > field.max_length) return { error: t("more-than", { max_length: field.max_length }) };
  const items = [];
  for (const [index, row] of rows.entries()) {
    const item = {};
    for (const [i, part] of field.items.entries()) {
      const { value, error } = parse_field(part, row[i]);
      if (error) return { error: `${index + 1}: ${words_of(part)} ${error}` };
      item[part.name] = value;
    }
    items.push(field.items.length === 1 ? item[field.items[0].name] : item);
  }
  return { value: items };
}

/// The arguments by name from what was entered by name: {args} or {error, field}.
export function arguments_of(fields, entered) {
  const args = {};
  for (const field of fields) {
    const { value, error } = parse_field(field, entered[field.name]);
    if (error) return { error: `${words_of(field)} ${error}`, field: field.name };
    args[field.name] = value;
  }
  return { args };
}

const words_of = (field) => argument_word(field.name);

/// The command that undoes `name` with `args` (by name), as its model says: {command, args}. Undefined: none.
export function safe_form(model, name, args) {
  const command = model.commands[name];
  const { safe } = command;
  if (typeof safe === "string") {
    const wanted = (model.commands[safe]?.args ?? []).filter((argument) => argument.name in args);
    return { command: safe, args: Object.fromEntries(wanted.map((argument) => [argument.name, args[argument.name]])) };
  }
  if (!Array.isArray(safe)) return undefined;
  const named = (command.args ?? []).map((argument, i) => [argument.name, safe[i] ?? args[argument.name]]);
  return { command: name, args: Object.fromEntries(named) };
}

/// What an answer of the bus means to a person: {kind: ok|error|refused|timeout, text}.
export function answer_text(answer) {
  switch (answer.status) {
    case "ok":
      if (answer.proof === "answer") return { kind: "ok", text: t("answer-answer", { answer: value_text(answer.answer) }) };
      return { kind: "ok", text: t("done-board") };
    case "error":
      return { kind: "error", text: t("boards-error", { code: answer.code ?? "", error: words_of_error(answer.error) }) };
    case "refused":
      return { kind: "refused", text: t("not-sent-why", { why: why_text(answer) }) };
    default:
      return { kind: "timeout", text: sentence(why_text(answer)) };
  }
}

/// Reasons beside which it is told what exactly.
export const says_more = (reason) => ["invalid", "not-kept", "not-loaded", "partly"].includes(reason);

/// Why there is no proof, or why it was not sent. What is said beside the reason is in English: others read the reason's own sentence first.
/// So do all of a board that is stopped: the page says who stopped it, in other words than those of the wire.
export function why_text({ status, reason, error }) {
  const known = known_text(`answer.${status}.${reason}`) ?? (status === "timeout" ? t("answer.timeout.") : undefined);
  if (error !== undefined && (!known || (locale.startsWith("en") && reason !== "stopped"))) return error;
  const whole = (known ?? reason ?? "") + (status === "timeout" && reason !== "no-value" ? t("maybe") : "");
  return error !== undefined && says_more(reason) ? `${whole} (${error})` : whole;
}

const sentence = (text) => `${first_up(text)}.`;

/// "invalid device number" for INVALID_DEVICE_NUMBER.
export function words_of_error(error) {
  const told = String(error ?? t("unknown")).toLowerCase().replaceAll("_", " ");
  return known_text(`error.${told}`) ?? told;
}

function value_text(answer) {
  return Object.values(answer ?? {}).map((value) => JSON.stringify(value)).join(" ").replace(/[{}"[\]]/g, " ")
    .replace(/\s+/g, " ").replace(/ ?, ?/g, ", ").trim();
}
