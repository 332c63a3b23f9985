// SPDX-License-Identifier: Apache-2.0
// Which light of a board may blink, so that a person finds the board.
import { t } from "./language.js";
import { mode_names, pins_of } from "./pins.js";

const own_light = [[/^ATmega/, 13], [/^RP2040/, 25]]; // of Uno, Nano, Mega, Leonardo; of a Pico

/// {pin, output} of a light that may be set, and whether its pin is an output already; else {refused}: a sentence.
export function light_of(board, properties) {
  const on_pin = (each) => /^io\/\d+$/.test(each.id);
  const named = properties.find((each) => on_pin(each) && each.kind === "switch" && each.meaning?.class === "light");
  const number = named ? Number(named.id.slice(3)) : own_light.find(([chip]) => chip.test(board?.chip ?? ""))?.[1];
  const pin = pins_of(board?.description).find((each) => each.number === number);
  if (!pin) return { refused: t("lesson-light-unknown") };
  const output = mode_names[pin.mode] === "output";
  const used = board.description.pin_modes?.[number] !== undefined || properties.some((each) => each.id === `io/${number}` && each.meaning?.class);
  if (pin.owner !== "" || !(pin.can & 1) || (!output && used))
    return { refused: t("lesson-light-in-use", { number }) };
  return { pin: number, output };
}

/// What is sent to the pins, one after the other: [command, arguments]. `lit`: it was on before.
export function blinks({ pin, output }, lit, times = 6) {
  const commands = output ? [] : [["mode", [pin, "output"]]];
  for (let i = 0; i < times; ++i) commands.push(["write", [pin, 1]], ["write", [pin, 0]]);
  if (lit) commands.push(["write", [pin, 1]]);
  return commands;
}
