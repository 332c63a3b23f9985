// SPDX-License-Identifier: Apache-2.0
// One service of a board: its live values with a plot, and forms for its commands, which stand where the board has its controls.
import { asked_text } from "../core/asked.js";
import { alive } from "../core/catalogue.js";
import { command_order, place_of, words_of_error } from "../core/form.js";
import { count_text, t } from "../core/language.js";
import { elements_of, floats, is_number, is_simple, value_text } from "../core/properties.js";
import { make_room, numbers_of, past_series, Series } from "../core/series.js";
import { duration_text, moment_text, service_text, time_of, title_of_service, unit_text, with_unit, word_text, words } from "../core/text.js";
import { bus, path_of, request } from "../net/bus.js";
import { offers_of_board } from "./add_widget.js";
import { before_picture, h, Part, set_text, small } from "./dom.js";
import "./command.js";
import { Kept } from "./kept.js";
import { status } from "./model.js";
import "./plot.js";
import "./widget.js";

const kMaxEvents = 16;    // different ones; the gateway keeps no more either
const kMaxText = 200;     // of a value that is no number
const kUsualHz = 10;      // what the gateway demands of a board where nothing is said
const kErrorHz = 1;
const kPast = 600;

const shortened = (text) => (text.length > kMaxText ? `${text.slice(0, kMaxText)} …` : text);

class Service extends Part {
  /// Call before it is put into the page. `controls` and `advanced`: where its forms stand; `pins`: it is the I/O service; `folded`: its plots are. `on_value`
  /// gets each report, `hz` how many of them a second are wanted where no property shows them.
  begin(board, service, { controls, advanced, on_value, folded, pins = false, hz = kUsualHz, on_demand = true }) {
    Object.assign(this, { board, service, controls, advanced, on_value, folded, pins, hz, on_demand });
    return this;
  }

  async shown() {
    this.groups = new Map(); // by unit, or name of the event -> {name, series, numbers, at, model}
    this.left_out = 0;
    this.values = h("div", { class: "values" });
    this.note = h("p", { class: "muted note" });
    this.plots = h("div", { class: "plots" });
    this.waiting = h("p", { class: "muted note" }, t("no-value-yet"));
    this.titles = [0, 1].map(() => h("h3", {}, h("span", {}), " ", small()));
    this.settings = h("details", { hidden: true }, h("summary", {}, t("advanced")), this.more = h("div", { class: "values" }), h("div", { class: "commands" }));
    this.card = h("div", { class: "card", hidden: true }, h("div", { class: "card-head" }, this.titles[1], this.adder(t("controls"), (each) => each.access !== "read")), this.set_box = h("div", { class: "setters" }), this.known = h("p", { class: "muted note" }), this.usual = h("div", { class: "commands" }));
    this.titles[0].id = `service-${this.service.name}`;
    this.show_titles();
    this.hidden = true;
    this.append(h("div", { class: "card-head" }, this.titles[0], this.adder(t("values"), (each) => each.access === "read")), this.values, this.waiting, this.note, this.plots);
    this.controls.append(this.card);
    if (this.pins) this.advanced.append(this.settings);
    this.while_shown(() => { this.card.remove(); this.settings.remove(); this.unfollow(); });
    this.refresh = before_picture(() => this.draw());
    this.every(1000, () => this.draw());
    this.listen(status, "change", () => { if (this.standing && this.loaded) this.stands(this.standing.properties, this.standing.values, new Map()); });
    this.listen(document, "visibilitychange", () => (document.hidden ? this.unfollow() : this.follow()));
    await this.load_model();
    this.loaded = true;
    if (this.standing) this.stands(this.standing.properties, this.standing.values);
  }

  adder(what, wanted) {
    return document.createElement("asip-add-widget").begin(t("what-service", { what, service: service_text(this.service.name) }),
      () => offers_of_board(this.board, (each) => each.service === this.service.name && wanted(each)));
  }

  /// Whether commands can reach the board now.
  set usable(on) { for (const each of [this.card, this.settings]) if (each) each.inert = !on; }

  /// How many values a second are wanted from now on.
  at_rate(hz) {
    if (hz === this.hz) return;
    this.hz = hz;
    this.unfollow();
    this.follow();
  }

  /// What people call it, else what the board does.
  title_text() { return this.service.label ?? title_of_service(this.service); }

  subtitle() {
    const { count, model, label, title } = this.service;
    const parts = label && title ? [title_of_service(this.service)] : [];
    if (count > 0) parts.push(`${count_text(count)} × ${this.element ? word_text(this.element) : t("element")}`);
    if (!model) parts.push(t("no-model-describes"));
    return parts.join(", ");
  }

  /// The same service with another count or title; what is entered and drawn stays.
  update(service) {
    this.service = service;
    this.show_titles();
  }

  show_titles() {
    for (const box of [this, this.card]) box.classList.toggle("named", Boolean(this.service.label));
    for (const title of this.titles) {
      set_text(title.firstChild, this.pins ? this.service.label ?? t("pins") : this.title_text());
      set_text(title.lastChild, this.subtitle());
      title.title = this.service.name;
    }
  }

  async load_model() {
    const path = path_of("boards", this.board, "services", this.service.name);
    try {
      const known = await request(path);
      this.model = typeof known.model === "object" ? known.model : undefined;
    } catch (problem) {
      set_text(this.note, problem.message);
    }
    this.element = this.model?.element;
    this.show_titles();
  }

  /// A service that says nothing has no place among the values.
  show_card() {
    const says = this.listed?.length > 0 || (!this.pins && (!this.model || Object.keys(this.model.events ?? {}).length > 0));
    this.hidden = !says && this.groups.size === 0 && this.note.textContent === "";
    this.waiting.hidden = [...this.groups.values()].some((group) => group.at !== undefined);
    const why = this.on_demand || !this.model?.commands?.report ? "" : ` ${t("agent-board")}`;
    set_text(this.waiting, t("no-value-yet") + why);
  }

  /// Forms are shown to a user while that user may send commands. A form that stays the same keeps what was typed.
  show_commands() {
    const wanted = status.may_command && this.model !== undefined && this.simple !== undefined;
    const names = wanted ? command_order(this.model) : [];
    const has_control = (name) => this.simple.some((each) => each.write?.[0] === name);
    const rare = names.filter((name) => this.pins || has_control(name) || place_of(this.model, name) === "advanced");
    const key = JSON.stringify([names, rare, this.elements, this.simple?.length > 0]);
    if (key === this.commands_key) return;
    this.commands_key = key;
    this.forms = new Map(names.map((name) => [name, document.createElement("asip-command").begin(this.board, { ...this.service, elements: this.elements }, this.model, name)]));
    const forms = (wanted_names) => wanted_names.map((name) => this.forms.get(name));
    const usual = names.filter((name) => !rare.includes(name));
    // Where there is a control, rare commands stand below it; those of a sensor below its values. They are moved
    // without forms: a form that is moved would be built twice.
    this.settings.lastChild.replaceChildren();
    if (this.pins) set_text(this.settings.firstChild, t("all-commands", { service: service_text(this.service.name) }));
    else (usual.length + this.simple?.length > 0 ? this.card : this).append(this.settings);
    this.usual.replaceChildren(...forms(usual));
    this.settings.lastChild.replaceChildren(...forms(rare));
    this.show_controls();
    this.settings.hidden = rare.length === 0;
  }

  // First the subscription, then the past: so nothing falls between, and the series skips what comes twice.
  // The gateway demands values of the board as long as this lasts. Of what the properties show, only errors are new here.
  follow() {
    if (this.end || !this.listed || !this.isConnected || document.hidden) return;
    let early = [];
    const hz = this.listed.length > 0 && !this.on_value ? kErrorHz : this.hz;
    const received = (message) => (early ? early.push(message) : this.received(message));
    this.end = bus.subscribe({ subscribe: `${this.board}/${this.service.name}`, max_hz: hz === kUsualHz ? undefined : hz }, received);
    this.load_past().then(() => {
      const messages = early;
      early = undefined;
      messages.forEach((message) => this.received(message));
    });
  }

  async load_past() {
    if (this.listed.length > 0) {
      const ids = this.listed.map((each) => each.id);
      const { past = {} } = await request(`${path_of("boards", this.board, "values")}?past=${kPast}&ids=${encodeURIComponent(ids.join())}`).catch(() => ({}));
      for (const group of this.groups.values()) group.series = past_series(group.numbers, past);
      for (const plot of [this.plots, this.more].flatMap((box) => [...box.querySelectorAll("asip-plot")])) plot.shows(this.groups.get(plot.group).series);
    } else {
      const past = await request(path_of("boards", this.board, "services", this.service.name, "values")).catch(() => undefined);
      for (const item of past?.items ?? []) this.received({ event: "value", ...item });
    }
  }

  unfollow() {
    this.end?.();
    this.end = undefined;
  }

  /// The list of the board, and how its properties stand; `changed`: the ids of what was said just now.
  stands(properties, values, changed = values) {
    this.standing = { properties, values };
    if (!this.loaded) return;
    const mine = properties.filter((each) => each.service === this.service.name);
    this.show_list(mine.filter((each) => each.access === "read" && !floats(each)));
    for (const group of this.groups.values()) if (group.listed && group.numbers.some(({ key }) => changed.has(key))) this.says(group, values, changed);
    this.elements = elements_of(mine);
    this.show_set(mine.filter((each) => each.access !== "read" && each.kind !== "button"), values, changed);
    this.show_card();
    this.refresh();
  }

  /// What can be set: those that one control says, and as text how others stand that commands set.
  show_set(settable, values, changed) {
    const simple = settable.filter((each) => is_simple(each) && (this.pins || !each.advanced));
    const key = JSON.stringify([simple, status.may_command]);
    if (key !== this.simple_key) {
      this.simple_key = key;
      this.simple = simple;
      this.make_setters(simple);
      changed = values;
    }
    for (const [id, setter] of this.setters) {
      if (this.state) setter.board_is(this.state);
      if (changed.has(id)) setter.says({ value: values.get(id)?.value });
    }
    const others = settable.filter((each) => !this.setters.has(each.id) && values.get(each.id)?.how);
    set_text(this.known, others.map((each) => `${each.name}: ${value_text(each, values.get(each.id).value)}`).join(", "));
    this.show_commands();
    this.show_controls();
  }

  /// A control that says the same as before stays: a person may be moving it.
  make_setters(simple) {
    const known = this.setters;
    this.setters = new Map(simple.map((each) => {
      const key = JSON.stringify([each, status.may_command]);
      const setter = known?.get(each.id);
      return [each.id, setter?.key === key ? setter : Object.assign(document.createElement("asip-widget").sets(this.board, each, { use: status.may_command }), { key })];
    }));
    const setters = [...this.setters.values()];
    for (const each of [...this.set_box.children]) if (!setters.includes(each)) each.remove();
    setters.forEach((each, at) => { if (this.set_box.children[at] !== each) this.set_box.insertBefore(each, this.set_box.children[at] ?? null); });
  }

  /// {state, reason} of its board.
  board_is(state) {
    this.state = state;
    for (const setter of this.setters?.values() ?? []) setter.board_is(state);
  }

  /// Its properties by unit, each with a plot of its own.
  show_list(listed) {
    const same = JSON.stringify(listed) === JSON.stringify(this.listed);
    this.listed = listed;
    if (!same) {
      for (const place of [this.values, this.more, this.plots]) place.replaceChildren();
      this.groups.clear();
      for (const each of listed) {
        const key = `${each.unit ?? ""}${each.advanced && !this.pins ? " more" : ""}`;
        const group = this.groups.get(key) ?? { key, name: this.title_text(), listed: true, place: each.advanced && !this.pins ? this.more : this.values, series: new Series(), numbers: [] };
        group.numbers.push({ key: each.id, name: each.name, unit: each.unit, value: undefined, property: each });
        this.groups.set(key, group);
      }
      this.unfollow();
    }
    this.follow();
  }

  says(group, values, changed) {
    const now = Date.now();
    for (const number of group.numbers) number.value = values.get(number.key)?.value;
    const ages = group.numbers.map(({ key }) => values.get(key)).filter((each) => each?.how);
    if (ages.length === 0) return;
    group.at = now - 1000 * Math.min(...ages.map((each) => each.age));
    group.series.add(group.at, group.numbers.filter(({ key, value }) => typeof value === "number" && changed.has(key)));
  }

  show_controls() { this.card.hidden = this.usual.childElementCount === 0 && !this.simple?.length && this.known.textContent === ""; }

  received(message) {
    if (message.event === "error") return this.board_error(message);
    if (message.cut !== undefined) {
      set_text(this.note, t("value-time", { time: moment_text(time_of(message.at)), n: message.cut }));
      this.show_card();
    }
    if (message.event !== "value" || message.value === null || typeof message.value !== "object") return;
    this.on_value?.(message.value);
    if (this.listed.length > 0 || this.pins) return; // what nobody uses floats
    const at = time_of(message.at) ?? Date.now();
    this.left_out += message.left_out ?? 0;
    for (const [name, value] of Object.entries(message.value)) this.value(name, value, at);
    this.show_card();
    this.refresh();
  }

  /// The values of a service without properties, as they stand in its report.
  value(name, value, at) {
    let group = this.groups.get(name);
    if (!group) {
      if (this.groups.size >= kMaxEvents) return;
      group = { key: name, name: words(name), place: this.values, series: new Series() };
      this.groups.set(name, group);
    }
    group.at = at;
    const numbers = numbers_of(name, value);
    group.numbers = numbers.length ? numbers : [{ key: name, name, value: shortened(JSON.stringify(value)) }];
    if (numbers.length) group.series.add(at, numbers);
  }

  board_error(message) {
    const error = message.value ?? message;
    this.on_value?.(error);
    const asked = typeof error.request === "string" ? asked_text(error.request, this.service.name, new Map(this.model ? [[this.model.name, this.model]] : [])) : "";
    set_text(this.note, `${t("board-reported", { time: moment_text(time_of(message.at)) })} ${shortened(words_of_error(error.error))}${asked && ` (${shortened(asked)})`}`);
    this.show_card();
  }

  draw() {
    for (const group of this.groups.values()) {
      if (!group.boxes) this.add_group(group);
      const present = new Set(group.numbers.map((number) => number.key));
      for (const number of group.numbers) {
        let box = group.boxes.get(number.key);
        if (!box) {
          make_room(group.boxes, present)?.parentElement.remove();
          group.boxes.set(number.key, (box = this.add_box(group, number)));
        }
        set_text(box, number.property ? value_text(number.property, number.value) || "–" : with_unit(number.value, number.unit));
      }
      const gone = this.state && !alive(this.state.state); // then what was kept can be looked at
      if (!group.plotted && group.numbers.some(({ value, property }) => typeof value === "number" || (gone && property && is_number(property)))) this.add_plot(group);
      const age = Date.now() - group.at;
      set_text(group.age, Number.isNaN(age) ? "" : age < 2000 ? t("just-now") : t("age-ago", { age: duration_text(age) }));
    }
    if (this.left_out > 0) set_text(this.note, t("n-values", { n: this.left_out }));
  }

  add_group(group) {
    group.boxes = new Map();
    group.age = h("span", { class: "age muted" });
    group.list = h("div", { class: "event", role: "group", "aria-label": group.name }, group.age);
    group.place.append(group.list);
  }

  add_box(group, number) {
    const value = h("span", { class: "value" });
    group.age.before(h("span", { class: "number" }, h("span", { class: "muted" }, number.name), value));
    return value;
  }

  add_plot(group) {
    group.plotted = true;
    const label = [this.board, group.name, group.listed && unit_text(group.numbers[0].unit)].filter(Boolean).join(" ");
    const plot = document.createElement("asip-plot").begin(group.series, label, label.replaceAll(" ", "-"), group.listed && new Kept((property, asked) => `${path_of("boards", this.board, "values", "kept")}?${new URLSearchParams({ property, ...asked })}`, () => group.numbers));
    plot.group = group.key;
    const [box, open] = group.place === this.values ? [this.plots, !this.folded] : [group.place, false];
    box.append(h("details", { open }, h("summary", {}, t("plot")), plot));
  }
}

customElements.define("asip-service", Service);
