// SPDX-License-Identifier: Apache-2.0
// One service of a board: its live values with a plot, and forms for its commands, which stand where the board has its controls.
import { command_order, place_of } from "../core/form.js";
import { elements_of, value_text } from "../core/properties.js";
import { make_room, numbers_of, Series } from "../core/series.js";
import { duration_text, moment_text, plural, time_of, with_unit, words } from "../core/text.js";
import { bus, path_of, request } from "../net/bus.js";
import { offers_of_board } from "./add_widget.js";
import { before_picture, h, Part, set_text } from "./dom.js";
import "./command.js";
import { status } from "./model.js";
import "./plot.js";

const kMaxEvents = 16;    // different ones; the gateway keeps no more either
const kMaxText = 200;     // of a value that is no number
const kUsualHz = 10;      // what the gateway demands of a board where nothing is said

const shortened = (text) => (text.length > kMaxText ? `${text.slice(0, kMaxText)} …` : text);

class Service extends Part {
  /// Call before it is put into the page. `controls` and `advanced`: where its forms stand. `on_value` gets each value and whether it
  /// is of the past, `pins` says that the board's pins show them, `hz` how many values a second are wanted.
  begin(board, service, { controls, advanced, on_value, pins = false, hz = kUsualHz, on_demand = true }) {
    Object.assign(this, { board, service, controls, advanced, on_value, pins, hz, on_demand });
    return this;
  }

  async shown() {
    this.events = new Map(); // name of the event -> {series, numbers, at, model}
    this.left_out = 0;
    this.values = h("div", { class: "values" });
    this.note = h("p", { class: "muted note" });
    this.plots = h("div", { class: "plots" });
    this.waiting = h("p", { class: "muted note" }, "No value yet.");
    this.titles = [0, 1].map(() => h("h3", {}, h("span", {}), " ", h("small", { class: "muted" })));
    this.settings = h("details", { hidden: true }, h("summary", {}, "Advanced"), h("div", { class: "commands" }));
    this.card = h("div", { class: "card", hidden: true }, h("div", { class: "card-head" }, this.titles[1], !this.pins && this.adder("controls", (kind) => kind === "switch" || kind === "slider")), this.usual = h("div", { class: "commands" }));
    this.titles[0].id = `service-${this.service.name}`;
    this.show_titles();
    this.hidden = true;
    this.append(h("div", { class: "card-head" }, this.titles[0], this.adder("values", (kind) => kind !== "switch" && kind !== "slider")), this.values, this.waiting, this.note, this.plots);
    this.controls.append(this.card);
    if (this.pins) this.advanced.append(this.settings);
    this.while_shown(() => { this.card.remove(); this.settings.remove(); this.unfollow(); });
    this.refresh = before_picture(() => this.draw());
    this.every(1000, () => this.draw());
    this.listen(status, "change", () => this.show_commands());
    this.listen(document, "visibilitychange", () => (document.hidden ? this.unfollow() : this.follow()));
    await this.load_model();
    this.follow();
  }

  adder(what, wanted) {
    const offers = async () => (await offers_of_board(this.board, (each) => each.service === this.service.name)).filter((offer) => wanted(offer.widget.kind));
    return document.createElement("asip-add-widget").begin(`${what} of ${this.service.name}`, offers);
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
  title_text() { return this.service.label ?? this.service.title ?? words(this.service.name); }

  subtitle() {
    const { name, count, model, label, title } = this.service;
    const parts = label && title ? [title, name] : [name];
    if (count > 0) parts.push(plural(count, this.element ?? "element"));
    if (!model) parts.push("no model describes it");
    return parts.join(", ");
  }

  /// The same service with another count or title; what is entered and drawn stays.
  update(service) {
    this.service = service;
    this.show_titles();
  }

  show_titles() {
    for (const title of this.titles) {
      set_text(title.firstChild, this.pins ? this.service.label ?? "Analog pins" : this.title_text());
      set_text(title.lastChild, this.subtitle());
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
    if (!this.isConnected) return;
    this.show_commands();
    this.show_card();
  }

  /// A service that says nothing has no place among the values; of the I/O service the pins show all but analog values.
  show_card() {
    const says = this.pins ? this.events.has("analog") : !this.model || Object.keys(this.model.events ?? {}).length > 0;
    this.hidden = !says && (this.pins || this.events.size === 0) && this.note.textContent === "";
    this.waiting.hidden = this.events.size > 0;
    const why = this.on_demand || !this.model?.commands?.report ? "" : " The agent of this board sets no periods: set one under “Advanced”.";
    set_text(this.waiting, `No value yet.${why}`);
  }

  /// Forms are there for users who may send commands, and go when the right to it ends.
  show_commands() {
    const wanted = status.may_command && this.model !== undefined;
    if (wanted === this.has_commands) return;
    this.has_commands = wanted;
    const names = wanted ? command_order(this.model) : [];
    this.forms = new Map(names.map((name) => [name, document.createElement("asip-command").begin(this.board, { ...this.service, elements: this.elements }, this.model, name)]));
    const rare = names.filter((name) => this.pins || place_of(this.model, name) === "advanced");
    const forms = (wanted_names) => wanted_names.map((name) => this.forms.get(name));
    const usual = names.filter((name) => !rare.includes(name));
    // Where there is a control, rare commands stand below it; those of a sensor below its values. They are moved
    // without forms: a form that is moved would be built twice.
    this.settings.lastChild.replaceChildren();
    if (this.pins) set_text(this.settings.firstChild, `All commands of ${this.service.name}`);
    else (usual.length > 0 ? this.card : this).append(this.settings);
    this.usual.replaceChildren(...forms(usual));
    this.settings.lastChild.replaceChildren(...forms(rare));
    this.card.hidden = usual.length === 0;
    this.settings.hidden = rare.length === 0;
    this.show_stands();
  }

  // First the subscription, then the past: so nothing falls between, and the series skips what comes twice.
  // The gateway demands values of the board as long as this lasts.
  follow() {
    if (this.end || !this.isConnected || document.hidden) return;
    let early = [];
    const received = (message) => (early ? early.push(message) : this.received(message));
    this.end = bus.subscribe({ subscribe: `${this.board}/${this.service.name}`, max_hz: this.hz === kUsualHz ? undefined : this.hz }, received);
    const past = request(path_of("boards", this.board, "services", this.service.name, "values")).catch(() => undefined);
    past.then((answer) => {
      for (const item of answer?.items ?? []) this.received({ event: "value", ...item }, true);
      const messages = early;
      early = undefined;
      messages.forEach((message) => this.received(message));
    });
  }

  unfollow() {
    this.end?.();
    this.end = undefined;
  }

  /// The list of the board, and how its properties stand. Other elements are other forms.
  stands(properties, values) {
    this.standing = { properties, values };
    const elements = elements_of(properties, this.service.name);
    if (JSON.stringify(elements) !== JSON.stringify(this.elements)) {
      this.elements = elements;
      this.has_commands &&= undefined;
      if (this.forms) this.show_commands();
    }
    this.show_stands();
  }

  show_stands() {
    if (!this.standing || !this.forms) return;
    const { properties, values } = this.standing;
    for (const form of this.forms.values()) if (form.inputs) form.stands(properties, values);
    if (this.has_commands === false && !this.pins) this.show_set(properties, values);
  }

  /// For users who may not send commands: how what others set stands.
  show_set(properties, values) {
    const known = properties.filter((each) => each.service === this.service.name && each.access === "both" && values.get(each.id)?.how);
    this.usual.replaceChildren(...known.map((each) => h("p", { class: "only-set" }, `${each.name}: `, h("strong", {}, value_text(each, values.get(each.id).value)))));
    this.card.hidden = known.length === 0;
  }

  received(message, past = false) {
    if (message.event === "error") return this.board_error(message);
    if (message.cut !== undefined) {
      set_text(this.note, `The value of ${moment_text(time_of(message.at))} is too long to be shown: ${plural(message.cut, "byte")}.`);
      this.show_card();
    }
    if (message.event !== "value" || message.value === null || typeof message.value !== "object") return;
    const at = time_of(message.at) ?? Date.now();
    this.left_out += message.left_out ?? 0;
    for (const [name, value] of Object.entries(message.value)) this.value(name, value, at);
    this.on_value?.(message.value, past);
    this.show_card();
    this.refresh();
  }

  value(name, value, at) {
    let event = this.events.get(name);
    if (!event) {
      if (this.events.size >= kMaxEvents) return;
      const model = Object.values(this.model?.events ?? {}).find((each) => each.name === name);
      event = { name, model, series: new Series(), element: this.element };
      this.events.set(name, event);
    }
    event.at = at;
    const numbers = numbers_of(name, value, event.model, this.element);
    if (this.pins && name === "analog") for (const number of numbers) number.name = `A${number.key}`;
    event.numbers = numbers.length ? numbers : [{ key: name, name, value: shortened(JSON.stringify(value)) }];
    if (numbers.length) event.series.add(at, numbers);
  }

  board_error(message) {
    const error = message.value ?? message;
    this.on_value?.(error);
    const text = (value) => shortened(typeof value === "string" ? value : JSON.stringify(value) ?? "");
    set_text(this.note, `The board reported an error at ${moment_text(time_of(message.at))}: ${text(error.error ?? "unknown")} (${text(error.request)})`);
    this.show_card();
  }

  draw() {
    for (const event of this.events.values()) {
      if (this.pins && event.name !== "analog") continue; // the pins show it
      if (!event.boxes) this.add_event(event);
      const present = new Set(event.numbers.map((number) => number.key));
      for (const number of event.numbers) {
        let box = event.boxes.get(number.key);
        if (!box) {
          make_room(event.boxes, present)?.parentElement.remove();
          event.boxes.set(number.key, (box = this.add_box(event, number)));
        }
        set_text(box, with_unit(number.value, number.unit));
      }
      const age = Date.now() - event.at;
      set_text(event.age, age < 2000 ? "just now" : `${duration_text(age)} ago`);
    }
    if (this.left_out > 0) set_text(this.note, `${plural(this.left_out, "value")} left out: this browser is too slow for all of them.`);
  }

  add_event(event) {
    event.boxes = new Map();
    event.age = h("span", { class: "age muted" });
    event.list = h("div", { class: "event", role: "group", "aria-label": words(event.name) }, event.age);
    this.values.append(event.list);
    if (event.numbers.some((number) => typeof number.value === "number")) this.add_plot(event);
  }

  add_box(event, number) {
    const value = h("span", { class: "value" });
    event.age.before(h("span", { class: "number" }, h("span", { class: "muted" }, number.name), value));
    return value;
  }

  add_plot(event) {
    const label = `${this.board} ${this.service.name} ${event.name}`;
    const plot = document.createElement("asip-plot").begin(event.series, label, label.replaceAll(" ", "-"));
    const box = h("details", { open: !this.pins }, h("summary", {}, "Plot"));
    box.append(plot);
    this.plots.append(box);
  }
}

customElements.define("asip-service", Service);
