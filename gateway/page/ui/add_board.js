// SPDX-License-Identifier: Apache-2.0
// A first board in four steps: which one, its firmware, its name and place, and what of it stands on a dashboard.
import { alive } from "../core/catalogue.js";
import { loading_of } from "../core/firmware.js";
import { t } from "../core/language.js";
import { path_of, request } from "../net/bus.js";
import { offers_of_board } from "./add_widget.js";
import { answer_line, command_line, field, fresh_id, h, muted, page_of, Part, set_text, small, svg } from "./dom.js";
import { kinds, load_firmware } from "./firmware.js";
import { boards, status } from "./model.js";
import { keep_labels } from "./names.js";

const steps = [[t("find"), "M8 3v5M16 3v5M6 8h12v4a6 6 0 0 1-12 0zM12 18v3"], [t("load"), "M6 14h12v7H6zM12 2v8M8.5 7l3.5 3.5L15.5 7"],
  [t("name"), "M3 12V4h8l10 10-8 8zM7.5 8.2v.1"], [t("show"), "M4 18a8 8 0 1 1 16 0zM12 18l4-6"]];
const kFind = 0, kLoad = 1, kName = 2, kShow = 3;

const picture = (d) => svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, svg("path", { d }));
const is_new = (row) => row.state === "no-asip" || (row.state === "online" && row.called === "");

class AddBoard extends Part {
  /// Call before it is put into the page. `name`: of a board that was chosen elsewhere; "": which one is asked.
  shown() {
    this.items = steps.map(([title, d]) => h("li", {}, picture(d), h("span", {}, title)));
    this.heading = h("h2", { tabindex: "-1" });
    this.panel = h("div", {});
    this.answer = answer_line();
    this.append(h("h1", { tabindex: "-1" }, t("add-board")), h("ol", { class: "steps" }, this.items), h("section", { class: "card add-board", "aria-label": t("step") }, this.heading, this.panel, this.answer));
    this.listen(boards, "change", () => this.changed());
    this.listen(boards, "board", (event) => { if (event.board === this.name) this.said(event.kind); });
    this.listen(status, "change", () => { if (this.step === kFind) this.changed(); });
    this.go(kFind);
    if (this.name) this.choose(this.name);
  }

  go(step) {
    this.step = step;
    this.items.forEach((item, i) => {
      item.className = i < step ? "done" : "";
      if (i === step) item.setAttribute("aria-current", "step");
      else item.removeAttribute("aria-current");
    });
    this.tell("", "");
    [this.find, this.load, this.give_name, this.show_value][step].call(this);
    if (step !== kFind && step !== kName) this.heading.focus();
  }

  row() { return boards.catalogue.rows.get(this.name); }

  choose(name) {
    this.name = name;
    if (this.row()?.state !== "no-asip") return this.go(kName);
    this.go(kLoad);
    return this.begin_loading("");
  }

  /// What is on the bus changed: a board to choose, or the one that was loaded is there.
  changed() {
    const state = this.row()?.state;
    if (this.step === kFind) this.show_boards();
    if (this.step === kLoad && alive(state) && state !== "updating") this.go(kName);
  }

  find() {
    set_text(this.heading, t("which-board"));
    this.list = h("ul", { class: "link-list" });
    this.note = h("p", { class: "muted", role: "status" });
    this.more = h("details", {}, h("summary", {}, t("not-list")),
      h("p", {}, t("agent-machine")),
      command_line("asip-agent --serial /dev/PORT"),
      (this.simulated = h("div", { hidden: true }, h("p", {}, t("you-have")),
        command_line("asip-sim --link /tmp/desk /usr/share/asip/boards/desk.json & asip-agent --serial /tmp/desk --name desk"))));
    this.panel.replaceChildren(this.note, this.list, this.more);
    import("../cable/cable.js").then(({ offer }) => offer(this.more));
    this.list_key = undefined;
    this.show_boards();
  }

  show_boards() {
    this.simulated.hidden = status.now?.simulator !== true;
    const rows = boards.catalogue.view().filter(is_new);
    const key = JSON.stringify([rows.map((row) => [row.name, row.state]), status.may_label]);
    if (key === this.list_key) return;
    this.list_key = key;
    if (rows.length === 0) this.more.open = true;
    set_text(this.note, !status.now ? "" : !status.may_label ? t("your-token") : rows.length === 0 ? t("plug-board") : "");
    this.list.replaceChildren(...(status.may_label ? rows : []).map((row) => h("li", {}, h("span", {}, row.name), " ",
      small(row.state === "no-asip" ? t("box-no") : [row.chip, row.sketch].filter(Boolean).join(", ")), " ",
      h("button", { class: "main", onclick: () => this.choose(row.name) }, row.state === "no-asip" ? t("load-row", { row: row.name }) : t("take-row", { row: row.name })))));
  }

  load() {
    set_text(this.heading, t("name-gets", { name: this.name }));
    const id = fresh_id("kind");
    this.kind = h("select", { id }, kinds.map(([value, text]) => h("option", { value }, text)));
    this.again = h("span", { class: "actions", hidden: true }, h("label", { for: id }, t("which-board"), " "), this.kind, " ", h("button", { class: "main", onclick: () => this.begin_loading(this.kind.value) }, t("try-again")));
    this.bar = h("progress", { max: 100, "aria-label": t("loading") });
    this.log = h("ol", { class: "loading-log" });
    this.panel.replaceChildren(this.bar, h("div", { role: "log" }, this.log), this.again);
  }

  /// A line of the log; what only counts on stands in the last one.
  note_step(text) {
    const of = text.split(" ").slice(0, 2).join(" ");
    if (this.log.lastChild?.of === of) return set_text(this.log.lastChild, text);
    return this.log.append(Object.assign(h("li", {}, text), { of }));
  }

  async begin_loading(kind) {
    this.again.hidden = true;
    this.bar.hidden = false;
    this.tell("", "");
    this.note_step(t("agent-asked"));
    const { kind: how, text } = await load_firmware(this.name, kind ? { board: kind } : {});
    if (!this.isConnected || this.step !== kLoad) return;
    this.note_step(text);
    if (how === "ok") return this.changed();
    this.bar.hidden = how !== ""; // "": it may go on
    this.again.hidden = how === "";
    this.tell(how, how === "refused" ? t("not-loaded") : "");
  }

  async said(kind) {
    if (this.step === kShow && kind === "properties") return this.show_value();
    if (this.step !== kLoad) return;
    const board = await request(path_of("boards", this.name)).catch(() => undefined);
    const loading = loading_of(board?.description);
    if (loading && this.step === kLoad) {
      this.bar.value = loading.percent;
      this.note_step(loading.text);
    }
    this.changed();
  }

  give_name() {
    const { tags = {}, called = "" } = this.row() ?? {};
    set_text(this.heading, t("what-name", { name: this.name }));
    const rooms = [...new Set([...boards.catalogue.rows.values()].map((row) => row.tags.room).filter(Boolean))];
    const list = h("datalist", { id: fresh_id("rooms") }, rooms.map((value) => h("option", { value })));
    const asked = (title, value, more) => {
      const input = h("input", { id: fresh_id("add"), type: "text", maxlength: 63, autocomplete: "off", value, ...more });
      return [input, field(title, input, "text")];
    };
    const [name, name_field] = asked(t("name-within"), called, { placeholder: t("desk") });
    const [room, room_field] = asked(t("place"), tags.room ?? "", { placeholder: t("office"), list: list.id });
    this.panel.replaceChildren(h("form", { "aria-label": t("name-place"), onsubmit: (event) => { event.preventDefault(); this.save(name.value.trim(), room.value.trim()); } },
      name_field, room_field, list, h("span", { class: "actions" }, h("button", { class: "main" }, t("save")))));
    name.focus();
  }

  async save(name, room) {
    const labels = { ...(name && { name }), ...(room && { room }) };
    if (Object.keys(labels).length === 0) return this.go(kShow);
    this.tell("", t("waiting-agent"));
    const { kind, text } = await keep_labels(this.name, { labels });
    if (kind !== "ok") return this.tell(kind, text);
    return this.go(kShow);
  }

  async show_value() {
    set_text(this.heading, t("what-stands"));
    const page = h("p", {}, h("a", { href: page_of("board", this.name) }, t("page")));
    const offers = await offers_of_board(this.name).catch(() => []);
    if (!this.isConnected || this.panel.contains(document.activeElement)) return; // a person is choosing
    if (status.you.arrange !== true) return this.panel.replaceChildren(muted(t("your-token-changes")), page);
    if (offers.length === 0) return this.panel.replaceChildren(muted(t("shows-nothing")), page);
    const adder = document.createElement("asip-add-widget").begin(t("value-name", { name: this.name }), () => offers,
      { title: t("my-boards"), done: (dashboard) => { location.hash = page_of("dashboard", dashboard); } });
    this.panel.replaceChildren(adder, page);
  }
}

customElements.define("asip-add-board", AddBoard);
