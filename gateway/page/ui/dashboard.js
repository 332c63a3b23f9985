// SPDX-License-Identifier: Apache-2.0
// One dashboard, live: to be looked at and used, full screen, too; and its editor.
import { kSizes, moved, name_of_title, selectors_of, title_of } from "../core/dashboard.js";
import { t } from "../core/language.js";
import { who_text } from "../core/text.js";
import { bus, path_of, request, request_with_tag } from "../net/bus.js";
import { answer_line, field, fresh_id, h, page_of, Part, set_text, small } from "./dom.js";
import { boards, status } from "./model.js";
import { offers_of_board } from "./add_widget.js";
import { kept_spans, kFirst } from "./plot.js";
import "./share.js";
import "./widget.js";

class Dashboard extends Part {
  shown() {
    this.board_states = new Map();
    this.heading = h("h1", { tabindex: "-1" }, this.name);
    this.note = h("p", { class: "muted", role: "status" }, "");
    this.grid = h("div", { class: "dashboard-grid", onkeydown: (event) => this.step(event) });
    this.follow_drags();
    this.edit_button = h("button", { "aria-expanded": "false", onclick: () => this.edit(this.editor.hidden) }, t("edit"));
    this.full_button = h("button", { onclick: () => this.full_screen() }, t("full-screen"));
    this.share = document.createElement("asip-share").begin(this.name);
    this.tools = h("span", { class: "tools dashboard-tools" }, this.full_button, this.edit_button);
    this.editor = h("section", { class: "dashboard-editor", "aria-label": t("editor"), hidden: true });
    this.append(h("p", { class: "back" }, h("a", { href: "#/dashboards" }, `← ${t("all-dashboards")}`)),
      h("div", { class: "title-row" }, this.heading, this.tools), this.share, this.note, this.editor, this.grid);
    this.listen(status, "change", () => this.allow());
    this.listen(document, "visibilitychange", () => (document.hidden ? this.unfollow() : this.follow()));
    this.listen(document, "fullscreenchange", () => document.body.classList.toggle("bare", document.fullscreenElement !== null || is_kiosk()));
    this.while_shown(() => { this.unfollow(); document.body.classList.toggle("bare", is_kiosk()); });
    this.allow();
    this.follow();
  }

  allow() {
    const arrange = status.you.arrange === true;
    this.edit_button.hidden = !arrange;
    this.share.hidden = !arrange;
    const { control } = status.you;
    this.may = { use: status.may_command || control === true, stop: status.may_stop || control === true };
    for (const widget of this.grid.children) Object.assign(widget, { may: this.may }).show();
  }

  async full_screen() {
    if (document.fullscreenElement) return document.exitFullscreen();
    return document.documentElement.requestFullscreen().catch(() => document.body.classList.toggle("bare"));
  }

  // The gateway demands values of the boards as long as this lasts.
  follow() {
    if (this.end || !this.isConnected || document.hidden) return;
    this.end = bus.subscribe({ subscribe: "$dashboard", name: this.name }, (message) => this.received(message));
  }

  unfollow() {
    this.end?.();
    this.end = undefined;
  }

  received(message) {
    const widget = message.id === undefined ? undefined : this.widgets?.get(message.id);
    if (message.event === "dashboard") this.show(message.dashboard, message.etag, message.tiles);
    else if (message.event === "gone") this.gone();
    else if (message.event === "widget") widget?.says(message);
    else if (message.event === "property") widget?.describe(message.property);
    else if (message.event === "past") widget?.past(message.points);
    else if (message.event === "board") this.board_is(message);
  }

  board_is(board) {
    this.board_states.set(board.board, board);
    for (const widget of this.widgets?.values() ?? []) if (widget.widget.board === board.board) widget.board_is(board);
  }

  gone() {
    this.document = undefined;
    this.grid.replaceChildren();
    this.editor.hidden = true;
    set_text(this.note, t("there-no-dashboard", { name: this.name }));
  }

  /// Widgets that stay as they are keep their element, with what they draw.
  show(document_, etag, tiles) {
    const before = this.widgets ?? new Map();
    // Those of labels come from the gateway: until it says them anew, they stay.
    tiles ??= document_.widgets.flatMap((each) => (each.labels ? [...before.values()].map((old) => old.widget).filter((old) => kept_id(old) === each.id) : each));
    const named = new Set(tiles.map((each) => each.board).filter(Boolean)).size > 1;
    this.document = document_;
    this.etag = etag;
    set_text(this.heading, document_.title || this.name);
    set_text(this.note, document_.widgets.length === 0 ? t("nothing-yet") : "");
    this.widgets = new Map(tiles.map((each) => {
      const old = before.get(each.id);
      const same = old && JSON.stringify(old.widget) === JSON.stringify(each);
      return [each.id, same ? old : document.createElement("asip-widget").begin(this.name, each, this.may)];
    }));
    const wanted = [...this.widgets.values()];
    for (const each of [...this.grid.children]) if (!wanted.includes(each)) each.remove();
    wanted.forEach((each, i) => { if (this.grid.children[i] !== each) this.grid.insertBefore(each, this.grid.children[i] ?? null); });
    for (const each of wanted) Object.assign(each, { named }).show_title();
    for (const state of this.board_states.values()) this.board_is(state);
    if (!this.editor.hidden && !this.saving && !this.editor.contains(document.activeElement)) this.show_editor();
    this.dispatchEvent(new Event("titled", { bubbles: true }));
  }

  edit(on) {
    this.editor.hidden = !on;
    this.grid.classList.toggle("editing", on);
    this.edit_button.setAttribute("aria-expanded", String(on));
    set_text(this.edit_button, on ? t("done") : t("edit"));
    if (on) this.show_editor();
  }

  show_editor() {
    if (!this.document) return;
    const title = h("input", { id: fresh_id("title"), type: "text", maxlength: 60, value: this.document.title, autocomplete: "off",
      onchange: () => this.change((document_) => ({ ...document_, title: title.value.trim() })) });
    this.answer = answer_line();
    this.editor.replaceChildren(h("h2", {}, t("editor")), field(t("title"), title, "text"),
      h("ul", { class: "widget-list" }, this.document.widgets.map((each) => this.widget_row(each))), this.adder(), this.answer,
      h("p", {}, this.remove_button()));
  }

  widget_row(widget) {
    const tile = [...this.widgets.values()].find((each) => kept_id(each.widget) === widget.id);
    const name = title_of(widget, tile?.property) || t("text");
    const change = (edit) => this.change((document_) => ({ ...document_, widgets: edit(document_.widgets) }));
    const set = (more) => change((all) => all.map((each) => (each.id === widget.id ? { ...each, ...more } : each)));
    const title = h("input", { type: "text", maxlength: 60, value: widget.title ?? "", placeholder: name, "aria-label": t("title-name", { name }), autocomplete: "off", onchange: () => set({ title: title.value.trim() }) });
    const size = h("select", { "aria-label": t("size-name", { name }), onchange: () => set({ size: size.value }) }, kSizes.map((each) => h("option", { value: each }, t(`size.${each}`))));
    size.value = widget.size ?? "small";
    const span = widget.kind === "plot" && h("select", { "aria-label": t("span-name", { name }), onchange: () => set({ span: span.value || undefined }) },
      [["", kFirst], ...Object.entries(kept_spans)].map(([value, [shown]]) => h("option", { value }, shown)));
    if (span) span.value = widget.span ?? "";
    const text = widget.kind === "text" && h("textarea", { rows: 2, maxlength: 1000, "aria-label": t("text-name", { name }), onchange: () => set({ text: text.value }) }, widget.text);
    return h("li", {}, h("span", { class: "muted" }, t(`kind.${widget.kind}`), widget.labels && h("small", {}, ` ${widget.labels}`)), title, text, span, size,
      h("button", { "aria-label": t("duplicate-name", { name }), onclick: () => change((all) => all.flatMap((each) => (each.id === widget.id ? [each, { ...each, id: undefined }] : each))) }, t("duplicate")),
      h("button", { "aria-label": t("remove-name", { name }), onclick: () => change((all) => all.filter((each) => each.id !== widget.id)) }, "×"));
  }

  adder() {
    const rows = boards.catalogue.view();
    const selectors = selectors_of(rows);
    const board = h("select", { id: fresh_id("board"), onchange: () => load() }, h("option", { value: "" }, t("choose")),
      selectors.length > 0 && h("optgroup", { label: t("one-tile") }, selectors.map((each) => h("option", { value: `=${each}` }, each))),
      h("optgroup", { label: t("one-board") }, rows.map((row) => h("option", { value: row.name }, row.called ? `${row.called}, ${row.name}` : row.name))));
    const what = h("select", { id: fresh_id("what"), disabled: true });
    const add = h("button", { type: "button", disabled: true, onclick: () => this.add(offers[Number(what.value)].widget) }, t("add"));
    let offers = [];
    const load = async () => {
      const labels = board.value.startsWith("=") ? board.value.slice(1) : undefined;
      const first = labels ? rows.find((row) => selectors_of([row]).includes(labels))?.name : board.value;
      offers = first ? await offers_of_board(first).catch(() => []) : [];
      if (labels) for (const offer of offers) Object.assign(offer.widget, { board: undefined, labels });
      what.replaceChildren(...offers.map((offer, i) => h("option", { value: i }, offer.text)));
      what.disabled = add.disabled = offers.length === 0;
    };
    return h("div", { class: "adder", role: "group", "aria-label": t("add-widget") }, field(t("board"), board),
      field(t("what"), what), add, h("button", { type: "button", onclick: () => this.add({ kind: "stop", title: t("stop") }) }, t("add-stop")),
      h("button", { type: "button", onclick: () => this.add({ kind: "text", text: t("write-here") }) }, t("add-text")));
  }

  /// A tile is dragged by its handle, with a finger, too; it is moved where it is let go.
  follow_drags() {
    let from;
    let to;
    const mark = (tile) => {
      to = tile;
      for (const each of this.grid.children) each.classList.toggle("drop", each === tile && each !== from);
    };
    const tile_of = (element) => element?.closest("asip-dashboard asip-widget") ?? undefined;
    const on = (name, handle) => this.grid.addEventListener(name, handle);
    on("pointerdown", (event) => {
      if (!event.target.closest(".grip")) return;
      from = tile_of(event.target);
      event.target.closest(".grip").setPointerCapture(event.pointerId);
    });
    on("pointermove", (event) => {
      if (!from) return;
      mark(tile_of(document.elementFromPoint(event.clientX, event.clientY)));
      to?.scrollIntoView({ block: "nearest" });
    });
    on("pointerup", () => { if (from && to) this.move(from, to); });
    for (const name of ["pointerup", "pointercancel"]) on(name, () => { from = undefined; mark(undefined); });
  }

  step(event) {
    const by = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    const from = event.target.closest(".grip")?.closest("asip-widget");
    if (!by || !from) return;
    event.preventDefault();
    const tiles = [...this.grid.children];
    const others = by > 0 ? tiles.slice(tiles.indexOf(from)) : tiles.slice(0, tiles.indexOf(from)).reverse();
    const to = others.find((each) => kept_id(each.widget) !== kept_id(from.widget));
    if (to) this.move(from, to);
  }

  /// To the place of another one. All tiles of labels go together.
  async move(from, to) {
    const place = (tile) => this.document.widgets.findIndex((each) => each.id === kept_id(tile.widget));
    const by = place(to) - place(from);
    if (by === 0 || this.saving) return;
    await this.change((document_) => ({ ...document_, widgets: moved(document_.widgets, kept_id(from.widget), by) }));
    this.widgets.get(from.widget.id)?.querySelector(".grip").focus();
  }

  add(widget) { return this.change((document_) => ({ ...document_, widgets: [...document_.widgets, widget] })); }

  remove_button() {
    const button = h("button", { onclick: () => {
      button.replaceWith(h("span", {}, t("remove-dashboard"), " ", h("button", { class: "danger", onclick: () => this.remove() }, t("yes-remove")), " ",
        h("button", { onclick: () => this.show_editor() }, t("keep"))));
    } }, t("remove-this-dashboard"));
    return button;
  }

  async remove() {
    try {
      await request(path_of("dashboards", this.name), { method: "DELETE", body: {} });
      location.hash = "#/dashboards";
    } catch (problem) {
      this.tell(problem.message);
    }
  }

  /// Nothing that another editor has changed meanwhile is overwritten: the change is refused, and what there is now is shown.
  async change(edit) {
    const document_ = edit(this.document);
    this.saving = true;
    try {
      await request(path_of("dashboards", this.name), { method: "PUT", body: { title: document_.title, widgets: document_.widgets }, headers: { "If-Match": this.etag } });
      const { body, tag } = await request_with_tag(path_of("dashboards", this.name));
      this.show(body, tag);
      this.saving = false;
      this.show_editor();
    } catch (problem) {
      this.saving = false;
      this.show_editor();
      this.tell(problem.status === 412 ? t("not-kept") : t("not-kept-message", { message: problem.message }));
    }
  }

  tell(text) {
    this.answer.className = "answer refused";
    set_text(this.answer, text);
  }
}

/// The id of the widget that a tile shows.
const kept_id = (tile) => tile.id.split(".")[0];

export const is_kiosk = () => Boolean(status.you.dashboard);

class Dashboards extends Part {
  shown() {
    this.list = h("ul", { class: "dashboard-list" });
    this.note = h("p", { class: "muted", role: "status" });
    this.title_input = h("input", { id: fresh_id("title"), type: "text", maxlength: 60, placeholder: t("greenhouse"), autocomplete: "off" });
    this.answer = answer_line();
    this.form = h("form", { "aria-label": t("new-dashboard-within"), hidden: true, onsubmit: (event) => { event.preventDefault(); this.make(); } },
      h("div", { class: "field text" }, h("label", { for: this.title_input.id }, t("new-dashboard-within")), this.title_input, h("button", { class: "main" }, t("make"))), this.answer);
    this.append(h("h1", { tabindex: "-1" }, t("dashboards")), this.note, this.list, this.form);
    this.listen(boards, "dashboards", () => this.load());
    this.listen(status, "change", () => { this.form.hidden = status.you.arrange !== true; });
    this.form.hidden = status.you.arrange !== true;
    this.load();
  }

  async load() {
    try {
      const { items } = await request("api/dashboards");
      this.list.replaceChildren(...items.map((each) => h("li", {}, h("a", { href: page_of("dashboard", each.name) }, each.title || each.name), " ",
        small(`${t("n-widgets", { n: each.widgets })}${each.by ? `, ${t("changed-who", { who: who_text(each.by) })}` : ""}`))));
      set_text(this.note, items.length > 0 ? "" : t("there-none-yet"));
    } catch (problem) {
      set_text(this.note, problem.message);
    }
  }

  async make() {
    const title = this.title_input.value.trim();
    const name = name_of_title(title);
    if (name === "") return set_text(this.answer, t("dashboard-needs"));
    try {
      await request(path_of("dashboards", name), { method: "PUT", body: { title, widgets: [] }, headers: { "If-None-Match": "*" } });
      location.hash = page_of("dashboard", name);
    } catch (problem) {
      set_text(this.answer, problem.message);
    }
    return undefined;
  }
}

customElements.define("asip-dashboard", Dashboard);
customElements.define("asip-dashboards", Dashboards);
