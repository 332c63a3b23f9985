// SPDX-License-Identifier: Apache-2.0
// What happened, in words; searched, and equal rows folded.
import { reason_text, time_of } from "./text.js";

const nobody = { loopback: "this machine" };
const commands = { command: "", stop: "stopped it", undone: "not renewed, undone:" };
const happenings = { added: "first seen", state: "", description: "description changed", conflict: "two agents use the name", resolved: "conflict over", forgotten: "forgotten" };

/// A change or command of the API as a row: {board, at, until, state, status, text, times}. `until`: of the oldest of equal ones.
export function row_of(item) {
  const at = time_of(item.at);
  const row = { board: item.board, at, until: at, state: item.by ? "" : item.state ?? "", status: item.by ? item.status ?? "" : "", times: item.by ? item.count ?? 1 : 1 };
  row.text = item.by
    ? [[`${nobody[item.by] ?? item.by}:`, commands[item.what] ?? item.what, item.service, asked_text(item.request)].filter(Boolean).join(" "), item.reason].filter(Boolean).join(", ")
    : [happenings[item.what] ?? item.what, item.was && `was ${item.was}`, reason_text(item.reason)].filter(Boolean).join(", ");
  return row;
}

/// {"write":[0,90]} is "write 0, 90"; what is long and for the agent is named only.
function asked_text(request) {
  try {
    const [[name, args]] = Object.entries(JSON.parse(request)); // throws where it is no object
    if (["labels", "names", "meanings"].includes(name)) return "names and labels";
    const values = args !== null && typeof args === "object" ? Object.entries(args).map(([key, value]) => (Array.isArray(args) ? value : `${key} ${value}`)) : args === true || args === null ? [] : [args];
    return [name, values.map((each) => (typeof each === "object" ? "…" : each)).join(", ")].filter((each) => each !== "").join(" ");
  } catch {
    return request; // a raw line, or cut
  }
}

/// Whether each of the words stands in it.
export function fits(row, text) {
  const all = `${row.board} ${row.state} ${row.status} ${row.text}`.toLowerCase();
  return text.toLowerCase().split(/\s+/).every((word) => all.includes(word));
}

/// Rows, the newest first; those that are equal to the one before are counted there. Of a board that comes and goes, pairs are.
export function folded(rows) {
  const out = [];
  for (const row of rows) {
    const equal = [out.at(-1), out.at(-2)].find((other, back) => other && same(other, row) && (back === 0 || out.at(-1).board === row.board));
    if (equal) {
      equal.times += row.times;
      equal.until = row.until;
    } else {
      out.push({ ...row });
    }
  }
  return out;
}

const same = (a, b) => a.board === b.board && a.state === b.state && a.status === b.status && a.text === b.text;
