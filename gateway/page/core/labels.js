// SPDX-License-Identifier: Apache-2.0
// Labels of boards as people type them: "room=lab, camera". The label `name` is the friendly name and has a field of its own.

/// Labels as one line of text, without the friendly name.
export function labels_text(labels) {
  return Object.entries(labels).filter(([key]) => key !== "name").map(([key, value]) => (value === "" ? key : `${key}=${value}`)).join(", ");
}

/// "room=lab, camera" -> {room: "lab", camera: ""}; without any comma blanks stand between labels, as in asipctl. A value may have no
/// comma; an agent's label that has one stays as it is.
export function parse_labels(text) {
  const labels = {};
  for (const part of text.split(text.includes(",") ? "," : /\s+/).map((each) => each.trim()).filter(Boolean)) {
    const at = part.indexOf("=");
    labels[at < 0 ? part : part.slice(0, at).trim()] = at < 0 ? "" : part.slice(at + 1).trim();
  }
  return labels;
}

/// What has to be said so that `now` becomes what was typed: values to set, null for what goes.
export function changed_labels(now, text, own_name) {
  const change = {};
  if (text.trim() !== labels_text(now)) {
    const wanted = parse_labels(text);
    for (const key of Object.keys(now)) if (key !== "name" && !(key in wanted)) change[key] = null;
    for (const [key, value] of Object.entries(wanted)) if (now[key] !== value) change[key] = value;
  }
  if (own_name !== (now.name ?? "")) change.name = own_name === "" ? null : own_name;
  return change;
}

/// The same of names: `entered` is a Map; an empty name removes it.
export function changed_names(now, entered) {
  const change = {};
  for (const [key, name] of entered) if (name !== (now[key] ?? "")) change[key] = name === "" ? null : name;
  return change;
}

/// Assignments for many boards: "room=lab" sets, "room-" removes: {room: "lab"}, {room: null}. Undefined: there is none.
export function parse_assignments(text) {
  const all = Object.entries(parse_labels(text)).map(([key, value]) => (value === "" && /.-$/.test(key) ? [key.slice(0, -1), null] : [key, value]));
  return all.length > 0 && all.every(([key]) => key) ? Object.fromEntries(all) : undefined;
}
