// SPDX-License-Identifier: Apache-2.0
// What happened, in words; searched, and equal rows folded.
import { asked_text } from "./asked.js";
import { t } from "./language.js";
import { reason_text, state_text, time_of, who_text, words } from "./text.js";

const ends = { ok: t("done-within"), timeout: t("no-answer"), error: t("error"), refused: t("refused") };
const commands = { command: "", stop: t("stopped-it"), undone: t("not-renewed-undone") };
const happenings = { added: t("first-seen"), state: "", description: t("description-changed"), conflict: t("two-agents"), resolved: t("conflict-over"), forgotten: t("forgotten") };

/// A change or command of the API as a row: {board, at, until, state, status, text, raw, times}. `until`: of the oldest of equal ones;
/// `raw`: as it was asked, for the search. `models` of services, by name.
export function row_of(item, models = new Map()) {
  const at = time_of(item.at);
  const row = { board: item.board, at, until: at, state: item.by ? "" : item.state ?? "", status: item.by ? ends[item.status] ?? item.status ?? "" : "", times: item.by ? item.count ?? 1 : 1, raw: "" };
  if (item.by) {
    const asked = item.request === undefined ? "" : asked_text(item.request, item.service, models);
    row.raw = [item.by, item.service, item.request].filter(Boolean).join(" ");
    const link = item.by.startsWith("link "); // says why, too
    row.text = [[!link && `${who_text(item.by)}:`, commands[item.what] ?? item.what, asked].filter(Boolean).join(" "), link && t("by-link", { link: item.by.replace("link", t("link-within")) }), item.reason && words(item.reason).toLowerCase()].filter(Boolean).join(", ");
  } else {
    const was = item.was && item.was !== item.state && t("was-was", { was: state_text(item.was) });
    row.text = [happenings[item.what] ?? item.what, was, reason_text(item.reason) || (item.was && !was && t("resumed-within"))].filter(Boolean).join(", ");
  }
  return row;
}

/// Whether each of the words stands in it.
export function fits(row, text) {
  const all = `${row.board} ${row.state} ${row.status} ${row.text} ${row.raw}`.toLowerCase();
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

const same = (a, b) => a.board === b.board && a.state === b.state && a.status === b.status && a.text === b.text && a.raw === b.raw;
