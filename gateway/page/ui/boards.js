// SPDX-License-Identifier: Apache-2.0
// The table of all boards.
import { attention_of, filter_of, named, query_of } from "../core/attention.js";
import { alive, states } from "../core/catalogue.js";
import { count_text, t } from "../core/language.js";
import { duration_text, moment_text, reason_text, service_text, state_text } from "../core/text.js";
import { moved_row, scroll_to_show, visible_rows } from "../core/virtual.js";
import { boards, status } from "./model.js";
import { load_firmware } from "./firmware.js";
import { RowValues } from "./row_values.js";
import { class_link } from "./class.js";
import "./notify.js";
import "./selection.js";
import { before_picture, h, page_of, Part, set_class, set_text, small } from "./dom.js";

const columns = [["name", t("board")], ["state", t("state")], ["since", t("since")], ["value", t("value")], ["services", t("services")], ["chip", t("chip-sketch")]];
const filter = filter_of(""); // kept from visit to visit
const picked = new Set();     // names of the boards that are selected
const kAtOnce = 4;            // boards that get a newer sketch
const kMaxFailures = 3;       // of these: the rest stays as it is

class Boards extends Part {
  /// `query`: the view that stands in the address; "" for the one that was seen last.
  begin(query) {
    if (query) Object.assign(filter, filter_of(query));
    return this;
  }

  shown() {
    this.rows = [];
    this.drawn = new Map(); // index -> row element
    this.spare = [];
    this.current = 0;
    this.values = new RowValues(before_picture(() => { if (this.isConnected) this.draw(); }));
    this.while_shown(() => this.values.end());
    this.selection = document.createElement("asip-selection").begin(picked, () => this.pick([...picked], false));
    this.append(h("h1", { class: "hidden" }, t("boards")), this.attention = h("div", { class: "attention", role: "status", hidden: true }), this.toolbar(), this.selection, this.table());
    this.keep_address();
    this.row_height = this.styled_row_height();
    this.listen(boards, "change", () => this.refresh());
    this.listen(this.scroll, "scroll", () => this.draw(true));
    this.listen(window, "resize", () => this.resized());
    this.listen(document, "visibilitychange", () => this.draw());
    this.listen(status, "change", () => {
      this.allow();
      this.show_attention(boards.catalogue);
    });
    this.allow();
    this.every(1000, () => this.draw());
    this.measure();
    this.refresh();
  }

  toolbar() {
    const search = h("input", { type: "search", "aria-label": t("search-boards"), placeholder: t("search-name"),
      value: filter.text, oninput: () => this.filtered({ text: search.value }) });
    this.kind = h("select", { "aria-label": t("kind-service"), onchange: () => this.filtered({ kind: this.kind.value }) });
    this.chips = h("div", { class: "chips", role: "group", "aria-label": t("state") });
    this.found = h("span", { class: "muted found", role: "status" });
    this.value = h("select", { "aria-label": t("value-shown"), onchange: () => this.filtered({ value: this.value.value }) });
    this.group = h("select", { "aria-label": t("group-label"), onchange: () => this.filtered({ group: this.group.value }) });
    this.adding = h("a", { class: "button", href: "#/add" }, t("add-board"));
    this.lending = class_link();
    return this.tools = h("div", { class: "toolbar" }, search, this.kind, this.value, this.group, this.chips, this.found, document.createElement("asip-notify"), this.adding, this.lending);
  }

  /// Boards are selected by users who may do something with them.
  allow() {
    this.classList.toggle("picks", status.may_command || status.may_label);
    this.invite.hidden = !status.may_label || !boards.catalogue.complete || boards.catalogue.rows.size > 0;
    this.adding.hidden = !status.may_label || boards.catalogue.rows.size === 0;
    this.lending.hidden = status.you.arrange !== true || (boards.catalogue.rows.size === 0 && status.you.lend !== true);
  }

  pick(names, on) {
    for (const name of names) if (on) picked.add(name); else picked.delete(name);
    this.selection.show();
    this.draw();
  }

  table() {
    this.pick_all = h("input", { type: "checkbox", "aria-label": t("select-all"),
      onchange: () => this.pick(this.rows.filter((row) => row.name).map((row) => row.name), this.pick_all.checked) });
    this.heads = columns.map(([key, title]) => h("span", { role: "columnheader", class: `c-${key}` }, key === "value" ? title
      : h("button", { onclick: () => this.filtered({ sort: key, descending: filter.sort === key && !filter.descending }) }, title)));
    this.filler = h("div", { class: "filler", role: "presentation" });
    this.scroll = h("div", { class: "scroll", role: "rowgroup", tabindex: "-1", onkeydown: (event) => this.key(event) }, this.filler);
    this.empty = h("p", {});
    this.invite = h("a", { class: "button main", href: "#/add" }, t("add-board"));
    this.empty_box = h("div", { class: "empty", hidden: true }, this.empty, this.invite);
    this.grid = h("div", { class: "boards", role: "table", "aria-label": t("boards") },
      h("div", { role: "rowgroup", class: "head-box" }, h("div", { role: "row", class: "row head", "data-by": t("sort-by") }, h("span", { role: "columnheader", class: "c-pick" }, this.pick_all), this.heads)), this.scroll);
    return h("div", { class: "table-box" }, this.grid, this.empty_box);
  }

  filtered(change) {
    Object.assign(filter, change);
    this.keep_address();
    this.scroll.scrollTop = 0;
    this.current = 0;
    this.refresh();
  }

  // A view can be bookmarked and sent to others; it is no step of its own for the browser's way back.
  keep_address() {
    const query = query_of(filter);
    history.replaceState(null, "", query ? `#/?${query}` : "#/");
  }

  /// Lost boards first, with the reason and since when.
  show_attention(catalogue) {
    const { lost, stopped, bare, outdated, reasons } = attention_of(catalogue.rows.values());
    const key = JSON.stringify([lost.map((row) => [row.name, row.reason, row.since]).slice(0, 5), lost.length, stopped.length, bare.map((row) => row.name), named(outdated).map((row) => row.name), outdated.length, this.loads, status.may_label, named(stopped).map((row) => row.name)]);
    if (key === this.shown_attention) return;
    this.shown_attention = key;
    const link = (row, more = "") => h("a", { href: page_of("board", row.name) }, row.name, more);
    const list = (rows, text) => named(rows).map((row, i) => [i > 0 ? ", " : "", link(row), text(row)]);
    const rest = (rows, state) => rows.length > named(rows).length && [" … ", h("button", { onclick: () => this.filtered({ state, text: "" }) }, t("show-all"))];
    const all_alike = reasons.length === 1 && lost.length > 1 ? ` (${t("all")}: ${reason_text(reasons[0][0])})` : "";
    const why = (row) => [all_alike ? "" : reason_text(row.reason), row.since && t("since-since", { since: moment_text(row.since) })].filter(Boolean).join(", ");
    this.attention.hidden = lost.length + stopped.length + bare.length + outdated.length === 0 && !this.loaded;
    this.attention.replaceChildren(
      lost.length > 0 ? h("p", {}, h("strong", { class: "state lost" }, t("n-boards-lost", { n: lost.length }), `${all_alike}: `), list(lost, (row) => ` (${why(row)})`), rest(lost, "lost")) : "",
      stopped.length > 0 ? h("p", {}, h("strong", { class: "state latched" }, t("n-boards-stopped", { n: stopped.length }), ": "), list(stopped, () => ""), rest(stopped, "")) : "",
      bare.length > 0 ? h("p", {}, h("strong", {}, t("n-without-asip", { n: bare.length }), ": "), list(bare, () => ""), " ",
        status.may_label && h("button", { disabled: this.loads, onclick: () => this.load_all(bare) }, this.loads ? `${t("loading")} …` : t("load-asipservices"))) : "",
      outdated.length > 0 ? h("p", {}, h("strong", {}, t("n-out-of-date", { n: outdated.length }), ": "), list(outdated, () => ""), outdated.length > named(outdated).length && " …", " ",
        status.may_label && h("button", { disabled: this.loads, onclick: () => this.update_all(outdated) }, this.loads ? `${t("loading")} …` : t("update-all"))) : "",
      this.loaded ? h("p", { class: "loaded" }, this.loaded) : "");
  }

  /// A class: all of them at once. How far each is stands in its row, and its page has the details.
  load_all(rows) {
    return this.load_some(rows, rows.length, async (row) => {
      const { text } = await load_firmware(row.name, {});
      return `${row.name}: ${text}`;
    });
  }

  /// What is left behind the third failure is out of date still: the button goes on with it.
  update_all(rows) {
    let failed = 0;
    return this.load_some(rows, kAtOnce, async ({ name }) => {
      if (failed >= kMaxFailures) return "";
      const { kind, text, reason } = await load_firmware(name, { update: true });
      const row = () => boards.catalogue.rows.get(name);
      while (kind === "" && row()?.state === "updating") await new Promise((later) => setTimeout(later, 1000));
      // Another user has its port: it is left out.
      const good = kind === "ok" || reason === "released" || (kind === "" && row()?.state === "online" && !row().outdated);
      if (!good) ++failed;
      return good ? "" : `${name}: ${text}`;
    });
  }

  /// `one`: has one of them loaded; what is to be said of it at the end, or "".
  async load_some(rows, at_once, one) {
    this.loads = true;
    this.loaded = "";
    this.refresh();
    const waiting = [...rows];
    const ends = [];
    const one_by_one = async () => {
      while (waiting.length > 0) ends.push(await one(waiting.shift()));
    };
    await Promise.all(Array.from({ length: at_once }, one_by_one));
    this.loads = false;
    this.loaded = ends.filter(Boolean).join(" ");
    this.shown_attention = undefined;
    if (this.isConnected) this.refresh();
  }

  styled_row_height() { return parseFloat(getComputedStyle(this).getPropertyValue("--row")); }

  /// A phone that is turned has rows of another height.
  resized() {
    const height = this.styled_row_height();
    if (height === this.row_height) return this.measure();
    const top = this.scroll.scrollTop / this.row_height;
    this.row_height = height;
    for (const [index, row] of this.drawn) row.style.transform = `translateY(${index * height}px)`;
    this.refresh();
    this.scroll.scrollTop = top * height;
  }

  measure() {
    this.height = this.scroll.clientHeight;
    this.draw();
  }

  refresh() {
    const { catalogue } = boards;
    this.rows = catalogue.view(filter);
    this.current = Math.max(0, Math.min(this.current, this.rows.length - 1));
    if (this.rows[this.current]?.group !== undefined) ++this.current;
    this.shown_boards = filter.group === "" ? this.rows.length : this.rows.filter((row) => row.name).length;
    this.show_filters(catalogue);
    this.show_attention(catalogue);
    this.heads.forEach((head, i) => {
      if (columns[i][0] === filter.sort) head.setAttribute("aria-sort", filter.descending ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    this.grid.setAttribute("aria-rowcount", this.rows.length + 1);
    this.filler.style.height = this.scroll.style.height = `${this.rows.length * this.row_height}px`;
    this.empty_box.hidden = this.rows.length > 0;
    this.grid.hidden = this.rows.length === 0;
    this.tools.hidden = catalogue.rows.size === 0; // nothing to look for
    set_text(this.empty, this.empty_text(catalogue));
    this.allow();
    const all = catalogue.rows.size;
    set_text(this.found, this.shown_boards === all ? t("n-boards", { n: all }) : t("shown-n", { shown: count_text(this.shown_boards), n: all }));
    this.measure();
  }

  empty_text(catalogue) {
    if (catalogue.rows.size > 0) return t("no-board");
    return catalogue.complete ? t("no-board-there") : t("looking-boards");
  }

  show_filters(catalogue) {
    const kinds = catalogue.kinds();
    const labels = catalogue.label_keys();
    const key = JSON.stringify([kinds, labels]);
    if (key !== this.shown_kinds) {
      this.shown_kinds = key;
      const fill = (select, first, names, chosen, text_of = service_text) => {
        const all = names.includes(chosen) || first.some(([value]) => value === chosen) ? names : [...names, chosen];
        select.replaceChildren(...first.map(([value, text]) => h("option", { value }, text)), ...all.map((name) => h("option", { value: name }, text_of(name))));
        select.value = chosen;
      };
      fill(this.kind, [["", t("all-services")]], kinds, filter.kind);
      fill(this.value, [["", t("first-value")], ["-", t("no-values")]], kinds, filter.value);
      fill(this.group, [["", t("not-grouped")]], labels, filter.group, (key) => key);
      this.group.hidden = labels.length === 0 && filter.group === "";
    }
    const counts = catalogue.counts();
    const wanted = ["", ...states.filter((state) => counts.has(state) || state === filter.state)];
    if (wanted.join() !== this.shown_states) {
      this.shown_states = wanted.join();
      this.chips.replaceChildren(...wanted.map((state) => h("button", { "data-state": state, onclick: () => this.filtered({ state }) },
        h("span", { class: state && `state ${state}` }, state ? state_text(state) : t("all")), h("span", { class: "count" }))));
    }
    for (const chip of this.chips.children) {
      const { state } = chip.dataset;
      chip.setAttribute("aria-pressed", state === filter.state);
      set_text(chip.lastChild, String(state === "" ? catalogue.rows.size : counts.get(state) ?? 0));
    }
  }

  /// `scrolled`: rows that were drawn before stand as they are; nothing is said anew in each frame.
  draw(scrolled = false) {
    const { first, end } = visible_rows(this.scroll.scrollTop, this.height, this.row_height, this.rows.length);
    for (const [index, row] of this.drawn) {
      if (index >= first && index < end) continue;
      if (row.contains(document.activeElement)) this.scroll.focus();
      this.drawn.delete(index);
      this.spare.push(row);
      row.hidden = true;
    }
    const now = Date.now();
    for (let index = first; index < end; ++index) {
      let row = this.drawn.get(index);
      if (row && scrolled) continue;
      if (!row) {
        row = this.spare.pop() ?? this.new_row();
        row.hidden = false;
        row.style.transform = `translateY(${index * this.row_height}px)`;
        row.setAttribute("aria-rowindex", index + 2);
        this.drawn.set(index, row);
      }
      this.fill(row, this.rows[index], index, now);
    }
    const seen = this.rows.slice(first, end).filter((row) => row.name && alive(row.state));
    const wanted = `${document.hidden} ${filter.value} ${seen.map((row) => row.name).join(" ")}`;
    if (wanted !== this.wanted_values) this.values.want(seen, filter.value, scrolled);
    this.wanted_values = wanted;
  }

  new_row() {
    const cells = columns.map(([key]) => h("span", { role: "cell", class: `c-${key}` }));
    cells[0].append(h("a", {}), " ", small());
    cells[1].append(h("span", {}));
    const box = h("input", { type: "checkbox", onchange: () => this.pick(row.names, box.checked) });
    const row = h("div", { role: "row", class: "row" }, h("span", { role: "cell", class: "c-pick" }, box), cells);
    this.filler.append(row);
    return row;
  }

  fill(row, board, index, now) {
    const [pick, name, state, since, value, services, chip] = row.children;
    const link = name.firstChild;
    const of_group = board.group !== undefined;
    row.classList.toggle("group", of_group);
    row.names = of_group ? board.names : [board.name];
    pick.firstChild.tabIndex = index === this.current || of_group ? 0 : -1;
    pick.firstChild.checked = row.names.every((each) => picked.has(each));
    pick.firstChild.setAttribute("aria-label", t("select-board", { board: of_group ? board.group : board.name }));
    if (of_group) return this.fill_group(row, board);
    set_text(link, board.called || board.name);
    set_text(value, this.values.text(board.name));
    const href = page_of("board", board.name);
    if (link.getAttribute("href") !== href) link.setAttribute("href", href);
    set_text(name.lastChild, [board.called && board.name, ...board.labels].filter(Boolean).join("  "));
    name.title = [board.name, ...board.labels].join(", ");
    link.tabIndex = index === this.current ? 0 : -1;
    const stopped = board.reason === "latched" && alive(board.state);
    set_text(state.firstChild, board.conflict ? `${state_text(board.state)}, ${t("conflict-within")}` : stopped ? t("stopped-within") : state_text(board.state));
    set_class(state.firstChild, `state ${stopped ? "latched" : board.state}`);
    set_text(since, board.since === undefined ? "" : duration_text(now - board.since));
    const why = reason_text(board.reason);
    since.title = [board.since === undefined ? state_text(board.state) : t("state-since-time", { state: state_text(board.state), time: moment_text(board.since, now) }), why].filter(Boolean).join(": ");
    state.title = why;
    const text = board.services.map(service_text).join(", ");
    set_text(services, text);
    services.title = text;
    set_text(chip, [board.chip, board.firmware].filter(Boolean).join(", "));
    row.classList.toggle("gone", !alive(board.state));
  }

  fill_group(row, { group, names }) {
    const [, name, ...others] = row.children;
    set_text(name.firstChild, "");
    name.firstChild.removeAttribute("href");
    set_text(name.lastChild, `${group} (${count_text(names.length)})`);
    name.title = "";
    set_text(others[0].firstChild, "");
    set_class(others[0].firstChild, "");
    for (const cell of others.slice(1)) set_text(cell, "");
    row.classList.remove("gone");
  }

  key(event) {
    if (event.target.type === "checkbox") return;
    let to = moved_row(event.key, this.current, this.rows.length, Math.floor(this.height / this.row_height));
    if (this.rows[to]?.group !== undefined) to = to < this.current && to > 0 ? to - 1 : to + 1; // a heading is no board
    if (to === undefined) return;
    event.preventDefault();
    this.current = to;
    this.scroll.scrollTop = scroll_to_show(to, this.scroll.scrollTop, this.height, this.row_height);
    this.draw();
    this.drawn.get(to)?.querySelector("a").focus({ preventScroll: true });
  }
}

customElements.define("asip-boards", Boards);
