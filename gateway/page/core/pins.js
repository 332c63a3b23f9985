// SPDX-License-Identifier: Apache-2.0
// The pins of a board as its description and its properties say.
import { floats, is_on, value_text } from "./properties.js";

export const mode_names = ["unallocated", "input", "input-pullup", "output", "analog", "pwm", "reserved", "other-service", "invalid"];
export const kDigital = 1;
export const kAnalog = 2;
export const kPwm = 4;

/// What each pin is: [{number, label, name, can, owner, mode, channel}]. `name`: what people call it, "" where they do not.
/// `owner` is "" (free), "system" or a service's name.
export function pins_of(description) {
  const pins = description?.pins;
  if (!pins?.capabilities) return [];
  const letters = new Map((description.services ?? []).map((service) => [service.id, service.name]));
  const channels = pins.analog ?? {};
  return [...pins.capabilities].map((digit, number) => {
    const letter = pins.owners?.[number] ?? "-";
    const channel = channels[number];
    return {
      number,
      channel,
      label: channel === undefined || !is_analog_label(number, pins.capabilities.length) ? String(number) : `A${channel}`,
      name: description.names?.pins?.[number] ?? "",
      can: Number(digit),
      owner: letter === "@" ? "system" : letter === "-" || letter === "I" ? "" : letters.get(letter) ?? letter,
      mode: Number(description.pin_modes?.[number] ?? pins.modes?.[number]), // that a command set, else as the board says
    };
  });
}

// A Leonardo's digital pins that are analog inputs too keep their numbers.
function is_analog_label(number, count) { return number >= first_analog(count); }
function first_analog(count) {
  if (count <= 22) return 14;
  return count >= 70 ? 54 : count >= 30 ? 18 : 14;
}

/// Rows as they are on the board, from top to bottom; each row is a list of groups of pins.
export function board_rows(pins) {
  const digital = pins.filter((pin) => !pin.label.startsWith("A"));
  const analog = pins.filter((pin) => pin.label.startsWith("A"));
  const downwards = (low, high) => digital.filter((pin) => pin.number >= low && pin.number <= high).reverse();
  const upwards = (low, high) => digital.filter((pin) => pin.number >= low && pin.number <= high);
  const rows = [[downwards(8, 13), downwards(0, 7)]];
  if (digital.length > 14) rows[0].push(upwards(14, 21));
  for (let low = 22; low < digital.length; low += 16) rows.push([upwards(low, low + 7), upwards(low + 8, low + 15)]);
  const analog_groups = [];
  for (let i = 0; i < analog.length; i += 8) analog_groups.push(analog.slice(i, i + 8));
  if (analog_groups.length) rows.push(analog_groups);
  return rows.map((groups) => groups.filter((group) => group.length > 0)).filter((row) => row.length > 0);
}

/// Modes that a free pin can be set to, by what it can do.
export function settable_modes(pin) {
  const modes = [];
  if (pin.can & kDigital) modes.push("input", "input-pullup", "output");
  if (pin.can & kPwm) modes.push("pwm");
  if (pin.can & kAnalog) modes.push("analog");
  return modes;
}

/// What is known of the pins from the properties of the board.
export class PinValues {
  constructor() { this.properties = new Map(); } // by pin: {property, value, how, events}

  /// The list of the board, and how its properties stand: id -> {value, how}.
  stands(properties, values) {
    const pins = properties.filter((each) => /^io\/\d+$/.test(each.id));
    this.properties = new Map(pins.map((property) => [Number(property.id.slice(3)), { property, ...values.get(property.id) }]));
  }

  /// {mode, text, level, told, floating}: level 0..1 for the light of the pin, undefined where nothing is known. `told`: the board does not
  /// report it; it is what was set last. `floating`: the value says nothing.
  state_of(pin) {
    const mode = mode_names[pin.mode];
    const { property, value, how, events } = this.properties.get(pin.number) ?? {};
    if (value === undefined || value === null) return { mode, text: value_text(property, value), level: undefined, told: false };
    const level = typeof value === "number" ? value / (property.max ?? 1) : Number(is_on(value) ?? 0);
    return { mode, text: value_text(property, value, events), level, told: how === "set", floating: floats(property) };
  }
}
