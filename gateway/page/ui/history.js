// SPDX-License-Identifier: Apache-2.0
// What happened to one board, or on the whole bus.
import { moment_text, reason_text, time_of } from "../core/text.js";
import { request } from "../net/bus.js";
import { h, Part, set_text, state_mark } from "./dom.js";
import { boards } from "./model.js";

const kPage = 50;
const commands = { command: "", stop: "stopped it", undone: "not renewed, undone:" };
const happenings = { added: "first seen", state: "", description: "description changed", conflict: "two agents use the name", resolved: "conflict over", forgotten: "forgotten" };

class History extends Part {
  /// Call before it is put into the page. `path` of the API; `with_board`: a column with the board's name.
  begin(path, with_board) {
    Object.assign(this, { path, with_board });
    return this;
  }

  shown() {
    this.body = h("tbody", {});
    const heads = ["Time", this.with_board && "Board", "State", "What happened"].filter(Boolean);
    this.table = h("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "History" },
      h("table", {}, h("thead", {}, h("tr", {}, heads.map((head) => h("th", { scope: "col" }, head)))), this.body));
    this.note = h("p", { class: "muted" });
    this.more = h("button", { hidden: true, onclick: () => this.load(this.cursor) }, "Earlier");
    this.append(this.table, this.note, this.more);
    this.load();
    let timer;
    this.listen(boards, "board", () => {
      timer ??= setTimeout(() => {
        timer = undefined;
        if (this.isConnected && !this.paged) this.load();
      }, 1500); // the registry writes it down a second later
    });
  }

  async load(cursor) {
    try {
      const answer = await request(`${this.path}?limit=${kPage}${cursor ? `&cursor=${encodeURIComponent(cursor)}` : ""}`);
      this.paged = Boolean(cursor);
      if (!cursor) this.body.replaceChildren();
      this.body.append(...answer.items.map((item) => this.row(item)));
      this.cursor = answer.cursor;
      set_text(this.note, this.body.childElementCount === 0 ? "Nothing happened yet." : "");
    } catch (problem) {
      this.cursor = undefined;
      set_text(this.note, problem.message);
    }
    this.table.hidden = this.body.childElementCount === 0;
    this.more.hidden = !this.cursor;
  }

  row(item) {
    if (item.by) return this.command_row(item);
    const what = [happenings[item.what] ?? item.what, item.was && `was ${item.was}`, reason_text(item.reason)].filter(Boolean).join(", ");
    return h("tr", {}, h("td", {}, moment_text(time_of(item.at))),
      this.with_board && h("td", {}, h("a", { href: `#/board/${encodeURIComponent(item.board)}` }, item.board)),
      h("td", {}, item.state ? state_mark(item.state) : ""), h("td", {}, what));
  }

  // Who did what.
  command_row(item) {
    const what = [[`${item.by}:`, commands[item.what] ?? item.what, item.service, item.request].filter(Boolean).join(" "), item.count > 1 && `${item.count} times`, item.reason].filter(Boolean).join(", ");
    return h("tr", {}, h("td", {}, moment_text(time_of(item.at))),
      this.with_board && h("td", {}, h("a", { href: `#/board/${encodeURIComponent(item.board)}` }, item.board)),
      h("td", { class: "muted" }, item.status), h("td", {}, what));
  }
}

customElements.define("asip-history", History);
