// SPDX-License-Identifier: Apache-2.0
// The links from and to a board: listed, made in three choices, turned on and off, removed.
import { alive } from "../core/catalogue.js";
import { t } from "../core/language.js";
import { is_source, is_target, rule_of, standing_of, ways_of } from "../core/rule.js";
import { moment_text, time_of } from "../core/text.js";
import { path_of, properties_of, request } from "../net/bus.js";
import { answer_line, field, fresh_id, h, muted, Part, set_class, set_text, small } from "./dom.js";
import { boards, status } from "./model.js";

const kMaxBoards = 40;
const kLookMs = 1000;

const id_of = (link) => `${link.board}/${link.name}`;

class Links extends Part {
  shown() {
    this.list = h("ul", { class: "link-list" });
    this.note = muted();
    this.answer = answer_line();
    this.open = h("button", { "aria-expanded": "false", onclick: () => this.toggle() }, t("make-link"));
    this.panel = h("div", { class: "add-panel", hidden: true });
    this.append(this.list, this.note, this.open, this.panel, this.answer);
    this.items = [];
    this.rows = new Map();
    this.listen(status, "change", () => this.show());
    this.every(kLookMs, () => document.hidden || this.load());
    this.load();
  }

  async load() {
    const shown = await request(path_of("boards", this.name, "links")).catch(() => undefined); // what is shown stays
    if (!shown || !this.isConnected) return;
    this.items = shown.items;
    this.set_aside = shown.set_aside;
    this.show();
  }

  show() {
    this.open.hidden = !status.may_label;
    this.panel.hidden ||= !status.may_label;
    set_text(this.note, [this.set_aside?.length > 0 && t("cannot-read", { which: this.set_aside.join("; ") }), this.items.length === 0 && t("link-lets"),
      status.now && !status.may_label && t("you-may")].filter(Boolean).join(" "));
    const rows = new Map(this.items.map((link) => [id_of(link), this.rows.get(id_of(link)) ?? h("li", {}, h("span", {}), h("span", {}), small(), h("span", { class: "link-tools" }))]));
    for (const [id, row] of this.rows) if (!rows.has(id)) row.remove();
    this.rows = rows;
    for (const link of this.items) this.show_row(rows.get(id_of(link)), link);
  }

  there(link) { return alive(boards.catalogue.rows.get(link.from.split("/")[0])?.state); }

  /// What is clicked stays where it is while the link goes on.
  show_row(row, link) {
    if (!row.isConnected) this.list.append(row);
    const [rule, state, last, tools] = row.children;
    const { text, kind } = standing_of(link, this.there(link));
    set_text(rule, `${link.board}: ${link.rule}`);
    set_class(state, kind);
    set_text(state, text);
    set_text(last, link.last ? `${link.last}${link.at ? `, ${moment_text(time_of(link.at))}` : ""}` : "");
    const key = JSON.stringify([link.yours, link.disabled, link.user, status.may_label, this.asked === id_of(link)]);
    if (key === row.tools_key) return;
    row.tools_key = key;
    tools.replaceChildren(...this.tools(link));
  }

  tools(link) {
    const id = id_of(link);
    const tool = (word, work, more = {}) => h("button", { "aria-label": `${word} ${id}`, onclick: work, ...more }, word);
    if (!link.yours) return status.may_label ? [small(link.user ? t("set-user", { user: link.user }) : t("set-others"))] : [];
    if (this.asked !== id) return [tool(link.disabled ? t("turn") : t("turn-off"), () => this.change(link, link.disabled ? "enable" : "disable")), tool(t("remove"), () => this.ask(id))];
    const no = tool(t("keep"), () => this.ask(undefined));
    queueMicrotask(() => no.focus());
    return [h("span", {}, t("remove-it")), tool(t("yes-remove"), () => this.change(link, "remove"), { class: "danger" }), no];
  }

  ask(id) {
    this.asked = id;
    this.show();
  }

  async change(link, what) {
    this.asked = undefined;
    await this.send(link.board, { [what]: link.name }, "");
  }

  /// True: it is done.
  async send(board, change, done) {
    try {
      await request(path_of("boards", board, "links"), { method: "POST", body: change });
      this.tell("ok", done);
      await this.load();
      return true;
    } catch (problem) {
      this.tell("refused", problem.message);
      return false;
    }
  }

  async toggle() {
    const open = this.panel.hidden;
    this.panel.hidden = !open;
    this.open.setAttribute("aria-expanded", String(open));
    if (!open) return;
    this.panel.replaceChildren(muted(t("looking-what")));
    const others = boards.catalogue.by_name().filter((row) => row.name !== this.name && alive(row.state));
    const names = [this.name, ...others.slice(0, kMaxBoards).map((row) => row.name)];
    const lists = await Promise.all(names.map((name) => properties_of(name).catch(() => [])));
    this.offers = new Map(names.map((name, i) => [name, lists[i]]));
    this.show_form(others.length > kMaxBoards);
  }

  show_form(more) {
    const offered = (wanted) => [...this.offers].map(([board, properties]) => [board, properties.filter(wanted)]).filter(([, properties]) => properties.length > 0);
    const sources = offered(is_source);
    const targets = offered(is_target);
    if (sources.length === 0 || targets.length === 0) return this.panel.replaceChildren(muted(t("no-board-value")));
    const select = (name, groups) => h("select", { id: fresh_id(name), onchange: () => this.choose() }, groups.map(([board, properties]) => h("optgroup", { label: boards.catalogue.rows.get(board)?.called || board },
      properties.map((each) => h("option", { value: `${board}/${each.id}` }, `${board}: ${each.name}`)))));
    const input = (name) => h("input", { id: fresh_id(name), type: "text", autocomplete: "off", size: 8 });
    this.from = select("from", sources);
    this.how = h("select", { id: fresh_id("how"), onchange: () => this.show_fields() });
    this.to = select("to", targets);
    this.inputs = { level: input("level"), back: input("back"), value: input("value"), otherwise: input("otherwise") };
    this.levels = [field(t("level"), this.inputs.level), field(t("back-again"), this.inputs.back)];
    this.values = [field(t("value-then"), this.inputs.value), field(t("value-else"), this.inputs.otherwise)];
    const save = async (event) => {
      event.preventDefault();
      await this.make();
    };
    this.panel.replaceChildren(h("form", { "aria-label": t("make-link"), onsubmit: save }, field(t("1-what-happens"), this.from), field(t("2-what"), this.how), this.levels, this.values, field(t("3-which"), this.to),
      h("span", { class: "actions" }, h("button", { class: "main" }, t("make-it")))), more ? muted(t("offered-board", { most: kMaxBoards })) : "");
    this.choose();
    this.from.focus();
  }

  property(select) {
    const [, board, id] = /^([^/]*)\/(.*)$/s.exec(select.value);
    return { board, id, property: this.offers.get(board).find((each) => each.id === id) };
  }

  choose() {
    const { when } = this.way ?? {};
    this.ways = ways_of(this.property(this.from).property, this.property(this.to).property);
    this.how.replaceChildren(...this.ways.map((each) => h("option", { value: each.when }, each.text)));
    if (this.ways.some((each) => each.when === when) && this.how_chosen) this.how.value = when;
    this.show_fields();
  }

  show_fields() {
    this.how_chosen = document.activeElement === this.how || this.how_chosen;
    this.way = this.ways.find((each) => each.when === this.how.value);
    for (const each of this.levels) each.hidden = !this.way?.level;
    for (const each of this.values) each.hidden = !this.way?.values;
  }

  async make() {
    const to = this.property(this.to);
    const typed = Object.fromEntries(Object.entries(this.inputs).map(([key, input]) => [key, input.closest(".field").hidden ? "" : input.value]));
    if (await this.send(to.board, { set: rule_of(this.from.value, to.id, this.way.when, typed) }, t("kept-boards"))) this.toggle();
  }
}

customElements.define("asip-links", Links);
