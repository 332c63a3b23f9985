// SPDX-License-Identifier: Apache-2.0
// What a user has to look after: boards that are lost, and boards that were stopped. And a view of the table in an address.
import { t } from "./language.js";
import { reason_text } from "./text.js";

const kNamed = 5;
const kBurstMs = 5000; // boards that are lost within this time are one loss

/// What the rows of the catalogue show: {lost: [row], stopped: [row], bare: [row], outdated: [row], reasons: [[reason, count]]}; lost ones
/// the newest first. `bare`: boards that speak no ASIP, which were never there to be lost.
export function attention_of(rows) {
  const lost = [];
  const stopped = [];
  const bare = [];
  const outdated = [];
  const reasons = new Map();
  for (const row of rows) {
    if (row.outdated && row.state === "online") outdated.push(row);
    if (row.state === "no-asip") {
      bare.push(row);
    } else if (row.state === "lost") {
      lost.push(row);
      reasons.set(row.reason, (reasons.get(row.reason) ?? 0) + 1);
    } else if (row.reason === "latched") {
      stopped.push(row);
    }
  }
  lost.sort((a, b) => (b.since ?? 0) - (a.since ?? 0));
  return { lost, stopped, bare, outdated, reasons: [...reasons].sort((a, b) => b[1] - a[1]) };
}

/// The boards that are named; of many only the first ones.
export const named = (rows) => rows.slice(0, kNamed);

/// In front of the page's title: "(2 lost) ".
export function title_badge({ lost, stopped }) {
  const parts = [lost.length > 0 && t("lost-lost", { lost: lost.length }), stopped.length > 0 && t("stopped-stopped", { stopped: stopped.length })].filter(Boolean);
  return parts.length > 0 ? `(${parts.join(", ")}) ` : "";
}

/// Notices of losses, each board's once: those that are lost when it begins are no news.
export class Losses {
  /// The rows of the catalogue now. {title, body} where boards were lost since the call before; a loss of many is one notice that grows.
  of(rows, now) {
    const lost = new Map([...rows].filter((row) => row.state === "lost").map((row) => [row.name, row]));
    const fresh = this.known && [...lost.values()].filter((row) => !this.known.has(row.name));
    this.known = new Set(lost.keys());
    if (!fresh?.length) return undefined;
    const goes_on = this.began !== undefined && now - this.began < kBurstMs;
    if (!goes_on) this.burst = new Map();
    for (const row of fresh) this.burst.set(row.name, row);
    if (!goes_on) this.began = now;
    return loss_text([...this.burst.values()]);
  }
}

function loss_text(rows) {
  const reasons = [...new Set(rows.map((row) => reason_text(row.reason)).filter(Boolean))].join("; ");
  const name = (row) => row.called || row.name;
  if (rows.length === 1) return { title: t("board-is-lost", { board: name(rows[0]) }), body: reasons };
  const more = rows.length > kNamed ? ", …" : "";
  return { title: t("n-boards-lost", { n: rows.length }), body: `${named(rows).map(name).join(", ")}${more}${reasons && `: ${reasons}`}` };
}

// `value`: the service whose value the table shows; "": the first sensor of each board, "-": none. `group`: the key of a label.
const defaults = { text: "", kind: "", state: "", value: "", group: "", sort: "name", descending: false };

/// What differs from the usual view, as it stands behind `#/?`; "" for the usual one.
export function query_of(filter) {
  const query = new URLSearchParams();
  for (const [name, usual] of Object.entries(defaults)) if (filter[name] !== usual) query.set(name, String(filter[name]));
  return query.toString();
}

/// The view that stands there; unknown members and values of anybody's address are passed over.
export function filter_of(query) {
  const given = new URLSearchParams(query);
  const filter = { ...defaults };
  for (const name of ["text", "kind", "state", "value", "group"]) filter[name] = given.get(name) ?? "";
  if (["name", "state", "since", "services", "chip"].includes(given.get("sort"))) filter.sort = given.get("sort");
  filter.descending = given.get("descending") === "true";
  return filter;
}
