// SPDX-License-Identifier: Apache-2.0
// Links: what can move what, and how. Their rules are the agent's; see docs/links.md.
import { t } from "./language.js";
import { floats } from "./properties.js";

const kMaxName = 63;

const two_states = (property) => ["switch", "binary", "light"].includes(property?.kind);
const is_number = (property) => ["number", "light"].includes(property?.kind) || (property?.kind === "sensor" && ["integer", "number"].includes(property.type));

export const is_source = (property) => (two_states(property) || is_number(property)) && !floats(property);
export const is_target = (property) => property.access !== "read" && property.kind !== "button";

/// How a source can move a target, the likeliest first: [{when, text, level, values}]. `level`: a number is asked for; `values`: what the
/// target gets is asked for, since it is neither on nor off.
export function ways_of(source, target) {
  const button = source?.meaning?.class === "button";
  const switches = two_states(target);
  const way = (when, text, level = false) => ({ when, text, level, values: !switches && !(when === "follows" && !two_states(source)) });
  return [
    ...(button && switches ? [way("toggles", t("each-press"))] : []),
    ...(two_states(source) ? [way("follows", button ? t("while-pressed") : t("while")), way("inverted", button ? t("while-released") : t("while-off"))] : []),
    ...(!button && two_states(source) && switches ? [way("toggles", t("switched-each"))] : []),
    ...(button ? [way("hold", t("set-long")), way("double", t("set-double"))] : []),
    ...(is_number(source) ? [way("above", t("above-level"), true), way("below", t("below-level"), true)] : []),
    ...(!two_states(source) && is_number(source) && !switches ? [way("follows", t("same-number"))] : []),
  ];
}

/// What a person typed as a value: "on", "90", "red".
export function value_of(text) {
  const word = text.trim();
  if (word === "on" || word === "off") return word === "on";
  return word !== "" && Number.isFinite(Number(word)) ? Number(word) : word;
}

/// What the gateway is asked to set; `typed`: texts of the fields, level, back, value and otherwise.
export function rule_of(from, to_id, when, typed = {}) {
  const name = `${from}-${to_id}`.replace(/[^A-Za-z0-9]+/g, "-").slice(-kMaxName).replace(/^-|-$/g, "");
  const rule = { name, from, when, to: to_id };
  for (const [key, text] of Object.entries({ level: typed.level, back: typed.back, value: typed.value, else: typed.otherwise })) {
    if (text?.trim()) rule[key] = value_of(text);
  }
  return rule;
}

/// How a link stands, in a few words: {text, kind}; `there`: whether the board of its source is.
export function standing_of(link, there) {
  if (link.disabled) return { text: t("off"), kind: "muted" };
  if (link.state === "on") return { text: t("on"), kind: "good" };
  if (link.suspended) return { text: t("waits-until"), kind: "warn" };
  const grant = there && link.state.endsWith(" is not heard") ? `. ${t("secured-bus")} asipctl secure link ${link.board} ${link.from.split("/")[0]}` : "";
  return { text: link.state + grant, kind: "bad" };
}
