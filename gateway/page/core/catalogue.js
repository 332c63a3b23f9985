// SPDX-License-Identifier: Apache-2.0
// The boards that are there, as a table shows them: rows by name, filtered and sorted.
import { firmware_text, shown_state } from "./firmware.js";
import { t } from "./language.js";
import { time_of } from "./text.js";

export const states = ["online", "sleeping", "updating", "no-asip", "lost", "offline"];
export const alive = (state) => state === "online" || state === "sleeping" || state === "updating";

/// Labels as they are written: ["room=lab", "camera"]; `name` is the board's friendly name and stands elsewhere.
export const label_texts = (labels) => Object.entries(labels ?? {}).filter(([key]) => key !== "name").map(([key, value]) => (value === "" ? key : `${key}=${value}`));

/// The service whose value a row of the table shows: that of the view; else that of the board's label `value`; "" its first sensor; undefined: none.
export function value_service(row, view) {
  if (view === "-") return undefined;
  const own = row.tags?.value;
  const name = view !== "" ? view : own ?? "";
  if (name === "" || row.services.includes(name)) return name;
  return view === "" ? "" : undefined;
}

function row_of(board, at, now) {
  const services = typeof board.services === "string" ? board.services.split(" ").filter(Boolean) : board.services ?? [];
  return {
    name: board.board,
    state: shown_state(board),
    reason: board.reason ?? "",
    chip: board.chip ?? "",
    firmware: firmware_text(board),
    sketch: board.sketch ?? "",
    outdated: Boolean(board.available),
    conflict: Boolean(board.conflict),
    labels: label_texts(board.labels),
    tags: board.labels ?? {},
    called: board.labels?.name ?? "",
    named: Object.values(board.names?.services ?? {}).join(" "),
    services: services.map((service) => (typeof service === "string" ? service : service.name)),
    since: time_of(board.since) ?? at ?? (board.age === undefined ? undefined : now - board.age * 1000),
    seen: time_of(board.last_seen) ?? (board.age === undefined ? undefined : now - board.age * 1000),
  };
}

export class Catalogue {
  constructor() { this.clear(); }

  clear() {
    this.rows = new Map();
    this.sorted = undefined;
    this.complete = false;
    this.version = 0;
    this.fresh = undefined; // names of the snapshot that is being read
  }

  /// One event of the catalogue's stream.
  apply(message, now = Date.now()) {
    ++this.version;
    const board = typeof message.board === "string" ? { ...message, board: message.board } : message.board;
    switch (message.event) {
      case "reset":
        this.complete = false;
        this.fresh = new Set();
        break;
      case "snapshot-end":
        for (const name of this.fresh ? [...this.rows.keys()] : []) if (!this.fresh.has(name)) this.rows.delete(name);
        this.fresh = undefined;
        this.sorted = undefined;
        this.complete = true;
        break;
      case "forgotten":
        this.rows.delete(board.board);
        this.sorted = undefined;
        break;
      default:
        if (!board?.board) return;
        this.fresh?.add(board.board);
        if (!this.rows.has(board.board)) this.sorted = undefined;
        this.rows.set(board.board, row_of(board, message.event === "state" ? time_of(message.at) : undefined, now));
    }
  }

  /// Counts by state, of all boards.
  counts() {
    const counts = new Map();
    for (const row of this.rows.values()) counts.set(row.state, (counts.get(row.state) ?? 0) + 1);
    return counts;
  }

  kinds() {
    const kinds = new Set();
    for (const row of this.rows.values()) for (const service of row.services) kinds.add(service);
    return [...kinds].sort();
  }

  /// Keys of labels that boards have.
  label_keys() {
    const keys = new Set();
    for (const row of this.rows.values()) for (const key of Object.keys(row.tags)) if (key !== "name") keys.add(key);
    return [...keys].sort();
  }

  /// Rows that fit; `text` is looked for in name, chip, sketch, services, their names and labels, each of its words.
  view({ text = "", kind = "", state = "", sort = "name", descending = false, group = "" } = {}) {
    const wanted = text.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = (row) => {
      if (state !== "" && row.state !== state) return false;
      if (kind !== "" && !row.services.includes(kind)) return false;
      if (wanted.length === 0) return true;
      const all = `${row.name} ${row.chip} ${row.firmware} ${row.services.join(" ")} ${row.called} ${row.named} ${row.labels.join(" ")}`.toLowerCase();
      return wanted.every((word) => all.includes(word));
    };
    const rows = this.by_name().filter(fits);
    if (sort !== "name") rows.sort(orders[sort]);
    if (descending) rows.reverse();
    return group === "" ? rows : grouped(rows, group);
  }

  // Comparing names costs much more than the rest: they are sorted again only where one came or went.
  by_name() {
    this.sorted ??= [...this.rows.keys()].sort(names.compare);
    return this.sorted.map((name) => this.rows.get(name));
  }
}

/// The same rows by the value of a label, each value behind a row {group, names} of its own; boards without the label come last.
function grouped(rows, key) {
  const groups = new Map();
  for (const row of rows) {
    const value = Object.hasOwn(row.tags, key) ? row.tags[key] : undefined;
    if (!groups.has(value)) groups.set(value, []);
    groups.get(value).push(row);
  }
  const values = [...groups.keys()].sort((a, b) => (a === undefined) - (b === undefined) || names.compare(a, b));
  const title = (value) => (value === undefined ? t("without-key", { key }) : value === "" ? key : `${key}: ${value}`);
  return values.flatMap((value) => [{ group: title(value), names: groups.get(value).map((row) => row.name) }, ...groups.get(value)]);
}

const names = new Intl.Collator("en", { numeric: true });
const orders = {
  state: (a, b) => states.indexOf(a.state) - states.indexOf(b.state),
  services: (a, b) => a.services.length - b.services.length,
  chip: (a, b) => names.compare(a.chip, b.chip) || names.compare(a.sketch, b.sketch),
  since: (a, b) => (b.since ?? 0) - (a.since ?? 0),
};
