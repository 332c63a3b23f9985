// SPDX-License-Identifier: Apache-2.0
// What can be read and set on a board, as the gateway lists it, and how it stands.
import { t } from "./language.js";
import { with_unit } from "./text.js";

const kMaxSliderSteps = 1023;
const kFullBrightness = 255;

const seen = [t("detected"), t("clear-within")];
const two_words = {
  __proto__: null, button: [t("pressed"), t("released")], door: [t("open-within"), t("closed")], window: [t("open-within"), t("closed")], moisture: [t("wet"), t("dry")],
  motion: seen, occupancy: seen, smoke: seen, vibration: seen,
};

/// The value of a property, for a person; "" where it is not known, "none" where the board says that it has none. `events`: of a
/// button, as they stand beside its value: how it is pressed.
export function value_text(property, value, events = []) {
  if (value === undefined) return "";
  if (value === null) return t("no-value");
  const act = events.at(-1)?.[1];
  if (typeof value === "boolean") return (two_words[property?.meaning?.class] ?? [t("on"), t("off")])[value ? 0 : 1] + (act === "hold" || act === "double" ? `, ${t(`press.${act}`)}` : "");
  if (typeof value === "number") return with_unit(value, property?.unit);
  if (typeof value === "string") return value;
  if (value.on === undefined) return JSON.stringify(value);
  if (!value.on) return t("off");
  return has_brightness(property) && value.brightness !== undefined ? `${Math.round((value.brightness * 100) / kFullBrightness)}%` : t("on");
}

/// Whether it is on: true, false, or undefined where it is not known, or has no such value.
export function is_on(value) {
  if (typeof value === "number") return value !== 0;
  return typeof value === "boolean" ? value : value?.on;
}

/// A light that is only on or off has none.
function has_brightness(property) { return property?.kind === "light" && property.write !== undefined && !property.choices?.length; }

/// A slider for it: {min, max, step}; undefined where none can be.
export function range_of(property) {
  if (has_brightness(property)) return { min: 0, max: kFullBrightness, step: 1 };
  const { kind, min, max } = property ?? {};
  if (kind !== "number" || min === undefined || max === undefined) return undefined;
  return { min, max, step: property.step ?? (property.type === "integer" ? 1 : (max - min) / 1000) };
}

/// Where the slider of a value stands; undefined where that is not known.
export function place_in(value) { return typeof value === "number" ? value : value?.on === false ? 0 : value?.brightness; }

/// The elements that the board has, of the properties of a service whose elements have a number.
export function elements_of(properties) {
  const parts = properties.map((each) => each.id.slice(each.service.length + 1).split("/")[0]);
  return [...new Set(parts.filter((part) => /^\d+$/.test(part)).map(Number))].sort((a, b) => a - b);
}

/// An analog pin without a name and a class: nothing says that something is connected to it, so its value floats.
export const floats = (property) => property?.service === "io" && property.kind === "sensor" && property.advanced === true;

export const is_number = (property) => property.type === "integer" || property.type === "number";

/// Whether something on the board moves: its stop and its controls come first.
export const moves = (properties) => properties.some((each) => each.advanced && each.kind === "number" && each.service !== "io");

/// Whether one switch or slider says all that can be set; a slider of very many steps does not.
export function is_simple(property) {
  const range = range_of(property);
  return range ? (range.max - range.min) / range.step <= kMaxSliderSteps : property.kind === "switch" || (property.kind === "light" && property.write !== undefined);
}
