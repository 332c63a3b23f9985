// SPDX-License-Identifier: Apache-2.0
// What happened to one board, or on the whole bus.
import { model_name } from "../core/asked.js";
import { fits, folded, renewed, row_of, some_of } from "../core/history.js";
import { t } from "../core/language.js";
import { first_up, moment_text, state_text } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { h, page_of, Part, set_text } from "./dom.js";
import { boards } from "./model.js";

const models = new Map(); // by name
let model_names;

/// Those that the services of these rows are described by: what was asked is told in their words.
async function load_models(items) {
  if (!items.some((each) => each.request !== undefined)) return models;
  model_names ??= request("api/models").then(({ items: all }) => all, () => (model_names = undefined));
  const all = await model_names ?? [];
  const names = all.map((each) => each.name);
  const wanted = new Set(items.filter((each) => each.request).map((each) => (each.service ? model_name(each.service, names) : all.find(({ id }) => id === each.request.split(",")[0])?.name)));
  await Promise.all([...wanted].filter((name) => name && !models.has(name)).map(async (name) => {
    const model = await request(path_of("models", name)).catch(() => undefined);
    if (model) models.set(name, model);
  }));
  return models;
}

const kPage = 50;
const kEnough = 20; // rows; where commands or boards fill what was asked for with fewer, more is
const kMorePages = 4;
const kMost = 5000; // rows, more than they are, while new ones come
let each_command = false; // kept from board to board
const kSearched = 1000; // a page of the search
const kSearchedPages = 10;

class History extends Part {
  /// Call before it is put into the page. `path` of the API; `with_board`: a column with the board's name. `pins`: what those of
  /// the board are called, now.
  begin(path, with_board, pins = () => undefined) {
    Object.assign(this, { path, with_board, pins });
    return this;
  }

  shown() {
    this.rows = [];
    this.turn = 0;
    this.body = h("tbody", {});
    const heads = [t("time"), this.with_board && t("board"), t("what-happened")].filter(Boolean);
    this.table = h("div", { class: "wide", tabindex: "0", role: "region", "aria-label": t("history") },
      h("table", {}, h("thead", {}, h("tr", {}, heads.map((head) => h("th", { scope: "col" }, head)))), this.body));
    this.note = h("p", { class: "muted", role: "status" });
    this.more = h("button", { hidden: true, onclick: () => this.load(this.cursor) }, t("earlier"));
    let typing;
    this.search = h("input", { type: "search", "aria-label": t("search-history"), placeholder: t("search-user"), oninput: () => {
      clearTimeout(typing);
      typing = setTimeout(() => this.load(), 300);
    } });
    const each = h("input", { type: "checkbox", onchange: () => { each_command = each.checked; this.show(); } });
    each.checked = each_command;
    this.append(h("div", { class: "toolbar" }, this.search, h("label", { class: "check" }, each, t("each-command"))), this.table, this.note, this.more);
    this.load();
    const again = () => { if (this.isConnected && !document.hidden && !this.earlier && this.search.value.trim() === "") this.refresh(); };
    this.every(5000, again); // commands are told to the registry alone
    let timer;
    this.listen(boards, "board", () => {
      timer ??= setTimeout(() => {
        timer = undefined;
        again();
      }, 1500); // the registry writes it down a second later
    });
  }

  /// {rows, cursor} of one page; undefined where something else is looked for by now.
  async page(limit, cursor, turn) {
    const answer = await request(`${this.path}?limit=${limit}${cursor ? `&cursor=${encodeURIComponent(cursor)}` : ""}`);
    const known = await load_models(answer.items);
    const rows = answer.items.map((item) => row_of(item, known, this.pins()));
    if (rows.length > 0) rows.at(-1).cursor = answer.cursor;
    return turn === this.turn ? { rows, cursor: answer.cursor } : undefined;
  }

  /// What is new, before what is there. Where even a large page does not reach that, it begins anew.
  async refresh() {
    const turn = this.turn;
    for (const limit of this.rows.length > 0 ? [kPage, kSearched] : []) {
      const page = await this.page(limit, undefined, turn).catch(() => undefined);
      if (!page || turn !== this.turn) return;
      const rows = renewed(this.rows, page.rows, kMost);
      if (!rows) continue;
      if (rows.at(-1).cursor) this.cursor = rows.at(-1).cursor;
      this.rows = rows;
      return this.show();
    }
    return this.load();
  }

  async load(cursor) {
    const text = this.search.value.trim();
    const turn = ++this.turn;
    this.earlier = Boolean(cursor);
    const rows = cursor ? this.rows : [];
    const wanted = rows.length + kPage;
    const shown = text || cursor ? 0 : kEnough;
    let searched = 0;
    let pages = 0;
    let problem;
    try {
      do {
        const page = await this.page(text || pages ? kSearched : kPage, cursor, turn);
        if (!page) return;
        searched += page.rows.length;
        rows.push(...(text ? page.rows.filter((row) => fits(row, text)) : page.rows));
        cursor = page.cursor;
      } while (cursor && (text ? rows.length < wanted && searched < kSearched * kSearchedPages : ++pages <= kMorePages && folded(rows, false).length < shown));
    } catch (fault) {
      problem = fault.message;
      cursor = undefined;
    }
    Object.assign(this, { rows, cursor, searched, problem, asked: text });
    this.show();
  }

  show() {
    const { rows, cursor, searched, problem, asked: text } = this;
    this.body.replaceChildren(...folded(rows, Boolean(text) || each_command).map((row) => this.row(row)));
    set_text(this.note, problem ?? (rows.length > 0 ? "" : !text ? t("nothing-happened-yet") : cursor ? t("not-among", { n: searched }) : t("not-among-n", { n: searched })));
    this.table.hidden = rows.length === 0;
    this.more.hidden = !this.cursor;
  }

  row(row) {
    const since = row.until !== row.at && (row.times > 1 || row.command) ? `, ${t("since-since", { since: moment_text(row.until) })}` : "";
    const times = row.times > 1 && `, ${t("n-times", { n: row.times })}`;
    const boards = row.boards ?? [row.board];
    return h("tr", {}, h("td", {}, moment_text(row.at)),
      this.with_board && h("td", {}, boards.length > 1 ? t("n-boards", { n: boards.length }) : h("a", { href: page_of("board", row.board) }, row.board)),
      h("td", {}, row.state && h("span", { class: `state ${row.state}` }, first_up(state_text(row.state))), row.state && row.text && ": ", row.text,
        times, since, boards.length > 1 && this.with_board && `: ${some_of(boards)}`));
  }
}

customElements.define("asip-history", History);
