// SPDX-License-Identifier: Apache-2.0
// What happened to one board, or on the whole bus.
import { model_name } from "../core/asked.js";
import { fits, folded, row_of } from "../core/history.js";
import { t } from "../core/language.js";
import { moment_text } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { h, page_of, Part, set_text, state_mark } from "./dom.js";
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
const kSearched = 1000; // a page of the search
const kSearchedPages = 10;

class History extends Part {
  /// Call before it is put into the page. `path` of the API; `with_board`: a column with the board's name.
  begin(path, with_board) {
    Object.assign(this, { path, with_board });
    return this;
  }

  shown() {
    this.rows = [];
    this.body = h("tbody", {});
    const heads = [t("time"), this.with_board && t("board"), t("state"), t("what-happened")].filter(Boolean);
    this.table = h("div", { class: "wide", tabindex: "0", role: "region", "aria-label": t("history") },
      h("table", {}, h("thead", {}, h("tr", {}, heads.map((head) => h("th", { scope: "col" }, head)))), this.body));
    this.note = h("p", { class: "muted", role: "status" });
    this.more = h("button", { hidden: true, onclick: () => this.load(this.cursor) }, t("earlier"));
    let typing;
    this.search = h("input", { type: "search", "aria-label": t("search-history"), placeholder: t("search-user"), oninput: () => {
      clearTimeout(typing);
      typing = setTimeout(() => this.load(), 300);
    } });
    this.append(h("div", { class: "toolbar" }, this.search), this.table, this.note, this.more);
    this.load();
    const again = () => { if (this.isConnected && !document.hidden && !this.paged && this.search.value.trim() === "") this.load(); };
    this.every(5000, again); // commands are told to the registry alone
    let timer;
    this.listen(boards, "board", () => {
      timer ??= setTimeout(() => {
        timer = undefined;
        again();
      }, 1500); // the registry writes it down a second later
    });
  }

  async load(cursor) {
    const text = this.search.value.trim();
    const turn = (this.turn = (this.turn ?? 0) + 1);
    const rows = cursor ? this.rows : [];
    const wanted = rows.length + kPage;
    let searched = 0;
    let problem;
    try {
      do {
        const answer = await request(`${this.path}?limit=${text ? kSearched : kPage}${cursor ? `&cursor=${encodeURIComponent(cursor)}` : ""}`);
        const known = await load_models(answer.items);
        if (turn !== this.turn) return; // something else is looked for by now
        searched += answer.items.length;
        const found = answer.items.map((item) => row_of(item, known));
        rows.push(...(text ? found.filter((row) => fits(row, text)) : found));
        cursor = answer.cursor;
      } while (text && cursor && rows.length < wanted && searched < kSearched * kSearchedPages);
      this.paged = rows.length > kPage;
    } catch (fault) {
      problem = fault.message;
      cursor = undefined;
    }
    this.rows = rows;
    this.cursor = cursor;
    this.body.replaceChildren(...folded(rows).map((row) => this.row(row)));
    set_text(this.note, problem ?? (rows.length > 0 ? "" : !text ? t("nothing-happened-yet") : cursor ? t("not-among", { n: searched }) : t("not-among-n", { n: searched })));
    this.table.hidden = rows.length === 0;
    this.more.hidden = !this.cursor;
  }

  row(row) {
    const times = row.times > 1 && `, ${t("n-times", { n: row.times })}${row.until !== row.at ? `, ${t("since-since", { since: moment_text(row.until) })}` : ""}`;
    return h("tr", {}, h("td", {}, moment_text(row.at)),
      this.with_board && h("td", {}, h("a", { href: page_of("board", row.board) }, row.board)),
      h("td", { class: row.status && "muted" }, row.state ? state_mark(row.state) : row.status), h("td", {}, row.text, times));
  }
}

customElements.define("asip-history", History);
