// SPDX-License-Identifier: Apache-2.0
// What can stand on a dashboard, and what a widget shows. A widget is as the gateway keeps it:
// {id, kind, title, size, board, property}; in place of `board` it may have `labels`: the gateway makes one of each board then.
import { t } from "./language.js";
import { is_number, moves, range_of } from "./properties.js";
import { state_text, unit_text } from "./text.js";

export const kSizes = ["small", "wide", "large"];
const kMaxOffers = 60;

/// A name for a new dashboard of what a person typed: "Green house!" is "green-house"; "" where nothing is left.
export function name_of_title(title) {
  const name = title.trim().toLowerCase().replace(/[^a-z0-9._-]+/g, "-").replace(/^[-.]+|[-.]+$/g, "").slice(0, 64);
  return ["in", "out", "error", "set"].includes(name) ? `${name}-1` : name;
}

/// What of the properties of a board can stand on a dashboard: [{text, widget}].
export function offers_of(board, properties) {
  return properties.flatMap((property) => kinds_of(property).map((kind) => {
    const unit = property.unit ? ` (${unit_text(property.unit)})` : "";
    return { text: `${property.name}${unit}: ${t(`kind.${kind}`)}`, widget: { kind, ...(kind === "plot" ? { size: "wide" } : {}), board, property: property.id } };
  })).slice(0, kMaxOffers);
}

// What moves is shown alone: it runs only while it is held.
function kinds_of(property) {
  if (moves([property])) return ["value"];
  if (property.access !== "read" && property.advanced && property.service !== "io") return [];
  const slider = range_of(property) ? ["slider"] : [];
  switch (property.kind) {
    case "sensor": return is_number(property) ? ["value", "plot", ...(property.max > property.min ? ["gauge"] : []), "lamp"] : ["value"];
    case "binary": return ["lamp", "value"];
    case "switch": return ["switch", "lamp"];
    case "light": return ["switch", ...slider, "lamp"];
    case "number": return [...slider, "value"];
    case "button": return [];
    default: return ["value"];
  }
}

/// Selectors of the labels that boards have, such as "class=4b"; `rows` of the catalogue.
export function selectors_of(rows) {
  const found = new Set();
  for (const { tags } of rows) for (const [key, value] of Object.entries(tags)) {
    if (key !== "name" && !value.includes('"')) found.add(value === "" ? key : `${key}=${/[,\s]/.test(value) ? `"${value}"` : value}`);
  }
  return [...found].sort();
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

/// A property that its board does not list: "servo 0 angle" for servo/0/angle.
const id_text = (id) => id.replace(/^io\/(.*)$/, (_, label) => t("pin-label-within", { label })).replaceAll("/", " ");

export function title_of(widget, property) {
  if (widget.title) return widget.title;
  if (!widget.property) return widget.kind === "stop" ? t("stop") : "";
  return property?.name ?? `${widget.board ?? widget.labels} ${id_text(widget.property)}`;
}

/// Why a widget can do nothing now; "" where it can. `board`: {state, reason} as the stream says.
export function trouble_of(widget, board, property) {
  if (!widget.board) return "";
  if (!board) return t("waiting-bus");
  if (board.state === "unknown") return t("board-board", { board: widget.board });
  if (board.state === "lost" || board.state === "offline") return t("board-board-state", { board: widget.board, state: state_text(board.state) });
  return board.state === "updating" ? t("board-board-port", { board: widget.board }) : property === null ? t("board-board-no", { board: widget.board, property: id_text(widget.property) })
    : property?.refused && ["switch", "slider"].includes(widget.kind) ? t("cannot-set", { refused: property.refused }) : "";
}
