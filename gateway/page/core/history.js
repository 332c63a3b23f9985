// SPDX-License-Identifier: Apache-2.0
// What happened, in sentences; searched, and folded: what is equal, what befell many boards at once, and commands that follow each other.
import { asked_text } from "./asked.js";
import { words_of_error } from "./form.js";
import { known_text, t } from "./language.js";
import { first_up, reason_text, state_text, time_of, who_text, words } from "./text.js";

const kTogetherMs = 5000;
const kMany = 3;
const ends = { timeout: t("no-answer"), error: t("error"), refused: t("refused") };
const happenings = { added: t("first-seen"), state: "", description: t("description-changed"), conflict: t("two-agents"), resolved: t("conflict-over"), forgotten: t("forgotten") };

/// How a command ended, where it was not executed; "" else.
function end_text({ status, reason = "" }) {
  if (status === "ok" || status === "sent") return "";
  return known_text(`answer.${status}.${reason}`) ?? [ends[status] ?? status, reason && words_of_error(words(reason))].filter(Boolean).join(", ");
}

/// A change or command of the API as a row: {board, at, until, state, text, raw, times}; of a command also `by`, and `failed` of `times`.
/// `until`: of the oldest of equal ones; `raw`: as it was asked, for the search. `models` of services, by name; `pins`: what they are called.
export function row_of(item, models = new Map(), pins = {}) {
  const at = time_of(item.at);
  const row = { board: item.board, at, until: at, state: "", times: 1, failed: 0, raw: "" };
  if (!item.by) {
    const was = item.was && item.was !== item.state && t("was-was", { was: state_text(item.was) });
    const text = [happenings[item.what] ?? item.what, reason_text(item.reason) || was || (item.was && t("resumed-within"))].filter(Boolean).join(", ");
    return { ...row, state: item.state ?? "", text: item.state ? text : first_up(text) };
  }
  const asked = item.what === "stop" ? t("stopped") : item.request === undefined ? "" : asked_text(item.request, item.service, models, pins);
  const what = [item.what === "undone" && t("not-renewed-undone"), asked].filter(Boolean).join(" ") || item.what;
  const by = item.by.startsWith("link ") ? item.by.replace("link", t("link-within")) : who_text(item.by); // a link says why, too
  const end = end_text(item);
  return { ...row, by, command: item.what === "command", times: item.count ?? 1, failed: end ? item.count ?? 1 : 0, raw: [item.by, item.service, item.request].filter(Boolean).join(" "),
    text: `${first_up(what)}, ${t("by-link", { link: by })}${end && `: ${end}`}` };
}

/// Whether each of the words stands in it.
export function fits(row, text) {
  const all = `${row.board} ${row.state && state_text(row.state)} ${row.text} ${row.raw}`.toLowerCase();
  return text.toLowerCase().split(/\s+/).every((word) => all.includes(word));
}

/// Rows, the newest first; those that are equal to the one before are counted there. Of a board that comes and goes, pairs are. What
/// befell many boards at once is one row with `boards`; so are commands that follow each other, unless `each` of them is wanted.
export function folded(rows, each = true) {
  const out = [];
  for (const row of rows) {
    const equal = [out.at(-1), out.at(-2)].find((other, back) => other && same(other, row) && (back === 0 || out.at(-1).board === row.board));
    if (equal) {
      equal.times += row.times;
      equal.failed += row.failed;
      equal.until = row.until;
    } else {
      out.push({ ...row });
    }
  }
  const one_loss = joined(out, (a, b) => a.state !== "" && a.state === b.state && a.text === b.text && a.until - b.at < kTogetherMs, (part) => names_in(part).length >= kMany);
  return each ? one_loss : joined(one_loss, (a, b) => a.command && b.command, (part) => part.length > kMany, commands_text);
}

const same = (a, b) => a.board === b.board && a.state === b.state && a.text === b.text && a.raw === b.raw;
const names_in = (rows) => [...new Set(rows.map((row) => row.board))];

/// Rows that follow each other as one, where they are `alike` and all of them are `enough`.
function joined(rows, alike, enough, text_of = (part) => part[0].text) {
  const out = [];
  for (let from = 0, to; from < rows.length; from = to) {
    for (to = from + 1; to < rows.length && alike(rows[to - 1], rows[to]);) ++to;
    const part = rows.slice(from, to);
    if (enough(part)) out.push({ ...part[0], boards: names_in(part), until: part.at(-1).until, text: text_of(part), times: 1 });
    else out.push(...part);
  }
  return out;
}

/// Rows with a page of newer ones before them; undefined where that does not reach them. Above `most`, the oldest go: the last row of a
/// page has the `cursor` of what is behind it, so that it can be loaded again.
export function renewed(before, page, most) {
  const end = page.at(-1)?.at;
  if (!(end <= before[0].at)) return undefined;
  const key = (row) => `${row.at} ${row.board} ${row.text} ${row.raw}`;
  const fresh = new Set(page.map(key));
  const rows = [...page, ...before.filter((row) => row.at < end || (row.at === end && !fresh.has(key(row))))];
  return rows.length > most ? rows.slice(0, rows.findLastIndex((row, i) => i < most && row.cursor) + 1 || most) : rows;
}

/// "a, b, c and 4 more"
export const some_of = (names) => [names.slice(0, kMany).join(", "), names.length > kMany && t("n-more", { n: names.length - kMany })].filter(Boolean).join(" ");

function commands_text(rows) {
  const sum = (key) => rows.reduce((all, row) => all + row[key], 0);
  const failed = sum("failed");
  return `${t("n-commands", { n: sum("times") })}, ${t("by-link", { link: some_of([...new Set(rows.map((row) => row.by))]) })}${failed > 0 ? `: ${t("n-failed", { n: failed })}` : ""}`;
}
