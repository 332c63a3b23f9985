// SPDX-License-Identifier: Apache-2.0
// Words and numbers for people.
import { known_text, locale, t } from "./language.js";

/// "3 s", "5 min", "2 h", "4 days"; "" where it is not known.
export function duration_text(ms) {
  if (!Number.isFinite(ms)) return "";
  const seconds = Math.max(0, Math.round(ms / 1000));
  if (seconds < 60) return `${seconds} s`;
  const minutes = Math.floor(seconds / 60);
  if (minutes < 60) return `${minutes} min`;
  const hours = Math.floor(minutes / 60);
  if (hours < 48) return `${hours} h`;
  return t("n-days", { n: Math.floor(hours / 24) });
}

/// Why a board is in its state; "" where there is nothing to explain. A word of a later version stays as it is.
export function reason_text(reason) { return known_text(`reason.${reason}`) ?? reason ?? ""; }

/// What a user is to the gateway.
export const role_text = (role) => known_text(`role.${role}`) ?? role;

/// A state of shown_state() in words.
export const state_text = (state) => known_text(`state.${state}`) ?? state;

const clock = new Intl.DateTimeFormat(locale, { hour: "2-digit", minute: "2-digit", second: "2-digit" });
const date = new Intl.DateTimeFormat(locale, { day: "numeric", month: "short", year: "numeric" });
const day = new Intl.DateTimeFormat(locale, { day: "numeric", month: "short" });
const minute = new Intl.DateTimeFormat(locale, { hour: "2-digit", minute: "2-digit" });
const measured = new Intl.NumberFormat(locale, { maximumFractionDigits: 4, useGrouping: false, signDisplay: "negative" });

export function clock_text(ms) { return clock.format(ms); }

/// At an axis of time; `far`: of hours or days.
export function tick_text(ms, far) {
  if (!far) return clock.format(ms);
  const at = new Date(ms);
  return (at.getHours() + at.getMinutes() === 0 ? day : minute).format(at);
}

/// The time alone for today, the day alone for others.
export const day_text = (ms) => (date.format(ms) === date.format(Date.now()) ? clock : date).format(ms);

/// The time alone for today, otherwise with its day.
export function moment_text(ms, now = Date.now()) {
  if (!Number.isFinite(ms)) return "";
  const its_day = date.format(ms);
  return its_day === date.format(now) ? clock.format(ms) : `${its_day} ${clock.format(ms)}`;
}

/// At most four digits behind the point, none that say nothing.
export function number_text(value) { return Math.abs(value) < 1e15 && typeof value === "number" ? measured.format(value) : String(value); }

const units = { degrees: "°", us: "µs" };
export function unit_text(unit) { return unit === undefined ? "" : units[unit] ?? known_text(`arg.${unit}`) ?? unit; }

export function with_unit(value, unit) {
  const text = unit_text(unit);
  if (text === "") return number_text(value);
  return number_text(value) + (text === "°" || text === "%" ? "" : "\u00a0") + text;
}

/// What is the same in this language stays as it is written.
function known_word(word) {
  const known = known_text(`word.${word.toLowerCase()}`);
  return known === word.toLowerCase() ? word : known;
}

/// A word of a model in the reader's language, as it stands within a sentence.
export const word_text = (word) => known_word(word) ?? word;

/// Words of a model in the reader's language, where all of them are known.
function in_language(text) {
  const each = text.split(" ").map((word) => (/^\d*$/.test(word) ? word : known_word(word)));
  return each.includes(undefined) ? undefined : first_up(each.join(" "));
}

/// "input-pullup" as a person reads it: "Input pullup".
export function words(name) {
  const text = String(name).replace(/[-_]/g, " ");
  return in_language(text) ?? first_up(text);
}

/// What a program counts, by its name with those of the objects around it: "boards online". A counter of a later version is told in its own words.
export const counter_text = (name) => known_text(`counter.${name}`) ?? words(name);

/// A title of a model, an argument of its commands and a choice of that. What is English stands in the models alone.
export const title_text = (title) => known_text(`model.${title}`) ?? title;
export const argument_word = (name) => known_text(`arg.${name}`) ?? word_text(name.replace(/[-_]/g, " "));
export const argument_text = (name) => first_up(argument_word(name));
export const choice_word = (name) => known_text(`mode.${name}`) ?? known_text(`arg.${name}`) ?? words(name).toLowerCase();
export const choice_text = (name) => first_up(choice_word(name));

/// A property with its name in the reader's language, unless a person has named it.
export const named = (property) => ({ ...property, name: in_language(property.name) ?? property.name });

/// What a service is, as its board says.
export const title_of_service = ({ name, title }) => (title ? known_text(`model.${title}`) ?? in_language(title) ?? title : words(name));

export const first_up = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/// A cell of a CSV file. What begins like a formula is one to a spreadsheet, also between quotes.
export const csv_cell = (text) => `"${text.replace(/^(?=[=+@\t\r-])/, "'").replaceAll('"', '""')}"`;

/// Milliseconds since 1970 from what the API gives: ISO text, seconds or milliseconds. Undefined: not a time.
export function time_of(value) {
  if (typeof value === "number") return value < 1e11 ? value * 1000 : value;
  const ms = Date.parse(value ?? "");
  return Number.isNaN(ms) ? undefined : ms;
}

/// What a service is called where no person has named it.
export const service_text = (name) => (name === "io" ? t("pins") : words(name));

const programs = { loopback: t("machine"), "(unnamed)": t("no-name"), "node-red": "Node-RED", "home-assistant": "Home Assistant", homie: "Homie", sparkplug: "Sparkplug" };
/// Who asked, as a person reads it.
export const who_text = (by) => programs[by] ?? by;
