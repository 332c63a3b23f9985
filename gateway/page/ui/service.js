// SPDX-License-Identifier: Apache-2.0
// One service of a board: its live values, a plot, and a form for each command.
import { command_order, set_text as words_of_set } from "../core/form.js";
import { make_room, numbers_of, Series } from "../core/series.js";
import { duration_text, moment_text, plural, time_of, with_unit, words } from "../core/text.js";
import { bus, path_of, request } from "../net/bus.js";
import { before_picture, h, Part, set_text } from "./dom.js";
import "./command.js";
import { status } from "./model.js";
import "./plot.js";

const kMaxEvents = 16;    // different ones; the gateway keeps no more either
const kMaxText = 200;     // of a value that is no number
const kOwnCommands = new Set(["mode", "write", "pwm"]); // of the I/O service: a click on the pin does it

const shortened = (text) => (text.length > kMaxText ? `${text.slice(0, kMaxText)} …` : text);

class Service extends Part {
  /// Call before it is put into the page. `on_value` gets each value and whether it is of the past, `pins` says that the board's pins show them.
  begin(board, service, { on_value, on_set, pins = false } = {}) {
    Object.assign(this, { board, service, on_value, on_set, pins });
    return this;
  }

  async shown() {
    this.events = new Map(); // name of the event -> {series, numbers, at, model}
    this.left_out = 0;
    this.values = h("div", { class: "values" });
    this.note = h("p", { class: "muted note" });
    this.plots = h("div", { class: "plots" });
    this.commands = h("div", { class: "commands" });
    this.heading = h("span", {}, this.title_text());
    this.append(h("h3", { id: `service-${this.service.name}` }, this.heading, " ",
      h("small", { class: "muted" }, this.subtitle())), this.values, this.note, this.plots, this.commands);
    this.refresh = before_picture(() => this.draw());
    this.every(1000, () => this.draw());
    this.listen(status, "change", () => this.show_commands());
    await this.load_model();
    if (this.isConnected) this.follow();
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
    set_text(this.heading, this.title_text());
    set_text(this.querySelector("small"), this.subtitle());
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
    set_text(this.querySelector("small"), this.subtitle());
    if (this.isConnected) this.show_commands();
  }

  /// Forms are there for those who may send commands, and go when the right to it ends.
  show_commands() {
    const wanted = status.may_command && this.model !== undefined;
    if (wanted === this.has_commands) return;
    this.has_commands = wanted;
    this.commands.replaceChildren();
    if (wanted) this.add_commands();
  }

  add_commands() {
    const names = command_order(this.model);
    const first = names.filter((name) => !(this.pins && kOwnCommands.has(name)));
    this.forms = new Map();
    const form = (name) => {
      const made = document.createElement("asip-command").begin(this.board, this.service, this.model, name);
      this.forms.set(name, made);
      return made;
    };
    if (!this.pins) {
      this.commands.append(...first.map(form));
      if (this.set) this.set_is(this.set);
      return;
    }
    this.commands.append(h("details", {}, h("summary", {}, "All commands"), h("div", { class: "commands" }, names.map(form))));
    if (this.set) this.set_is(this.set);
  }

  // First the subscription, then the past: so nothing falls between, and the series skips what comes twice.
  follow() {
    let early = [];
    const received = (message) => (early ? early.push(message) : this.received(message));
    this.while_shown(bus.subscribe({ subscribe: `${this.board}/${this.service.name}` }, received));
    const past = request(path_of("boards", this.board, "services", this.service.name, "values")).catch(() => undefined);
    past.then((answer) => {
      for (const item of answer?.items ?? []) if (item.set === undefined) this.received({ event: "value", ...item }, true);
      const messages = early;
      early = undefined;
      messages.forEach((message) => this.received(message));
    });
  }

  /// What the board's agent says that was set, of all senders.
  set_is(set) {
    this.set = set;
    this.on_set?.(set);
    for (const [name, form] of this.forms ?? []) form.now_set?.(words_of_set(set, this.model, name));
  }

  received(message, past = false) {
    if (message.event === "set") return past ? undefined : this.set_is(message.value);
    if (message.event === "error") return this.board_error(message);
    if (message.cut !== undefined) set_text(this.note, `The value of ${moment_text(time_of(message.at))} is too long to be shown: ${plural(message.cut, "byte")}.`);
    if (message.event !== "value" || message.value === null || typeof message.value !== "object") return;
    const at = time_of(message.at) ?? Date.now();
    this.left_out += message.left_out ?? 0;
    for (const [name, value] of Object.entries(message.value)) this.value(name, value, at);
    this.on_value?.(message.value, past);
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
