// SPDX-License-Identifier: Apache-2.0
// One widget of a dashboard, as it is looked at and used.
import { title_of, trouble_of } from "../core/dashboard.js";
import { t } from "../core/language.js";
import { is_on, place_in, range_of, value_text } from "../core/properties.js";
import { Series } from "../core/series.js";
import { duration_text, named, time_of, with_unit } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { answer_line, h, Part, set_text, small, svg } from "./dom.js";
import { Kept } from "./kept.js";
import { status } from "./model.js";
import { kept_spans } from "./plot.js";

const kOldMs = 3000;      // beyond, a value says how old it is
const kSlideMs = 150;     // a moved slider is sent at most so often

class Widget extends Part {
  /// Call before it is put into the page. `may`: {use, stop}: which controls may be used.
  begin(dashboard, widget, may) {
    Object.assign(this, { widget, may, grip: h("button", { class: "grip", title: t("drag-or") }, "⠿ ", h("span", { class: "hidden" }, t("move"))) });
    this.path = path_of("dashboards", dashboard, "widgets", widget.id);
    this.ask = (body) => request(this.path, { method: "POST", body });
    return this;
  }

  /// The same for a property of a board that can be set, outside of a dashboard.
  sets(board, property, may) {
    const kind = !may.use ? "value" : range_of(property) ? "slider" : "switch";
    Object.assign(this, { widget: { kind, board, property: property.id }, property, may, level: "h3" });
    this.ask = ({ value }) => request(path_of("boards", board, "values"), { method: "PUT", body: { [property.id]: value } });
    return this;
  }

  shown() {
    const { widget } = this;
    this.className = `kind-${widget.kind} ${widget.size ?? "small"}`;
    this.heading = h(this.level ?? "h2", {});
    this.of = h("span", { class: "of-board" }); // whose it is, where there are several
    this.trouble = h("p", { class: "trouble", role: "status" });
    this.answer = answer_line();
    this.body = h("div", { class: "widget-body" });
    this.setAttribute("role", "group");
    this.replaceChildren(this.grip ?? "", this.of, this.heading, this.body, this.answer, this.trouble);
    this[`make_${widget.kind}`]?.();
    this.show_title();
    this.show();
    if (widget.kind === "value") this.every(1000, () => this.show());
  }

  /// What its property is, as the board lists it; null: the board has no such property.
  describe(property) {
    this.property = property && named(property);
    if (!this.isConnected) return;
    this.show_title();
    if (this.input) Object.assign(this.input, range_of(property) ?? {});
    this.show();
  }

  show_title() {
    const title = title_of(this.widget, this.property);
    const of = this.named ? this.board?.label ?? this.widget.board ?? "" : "";
    set_text(this.of, of);
    set_text(this.heading, title);
    this.heading.hidden = title === "" || this.widget.kind === "stop";
    const label = [title || t("text"), of].filter(Boolean).join(", ");
    for (const each of [this, this.button, this.input]) each?.setAttribute("aria-label", label);
    if (this.grip) set_text(this.grip.lastChild, t("move-label", { label }));
  }

  make_value() { this.body.append((this.text = h("span", { class: "big" })), " ", (this.age = small())); }

  make_plot() {
    this.series = new Series();
    this.text = h("span", { class: "big" });
    const title = title_of(this.widget, this.property);
    const first = kept_spans[this.widget.span];
    // A link shows no more of the past than its plot.
    const kept = status.you.dashboard && !first ? undefined
      : new Kept((_, asked) => `${this.path}/kept?${new URLSearchParams(asked)}`, () => [{ ...this.point(), key: this.widget.property }], status.you.dashboard ? first[1] : undefined);
    this.body.append(this.text, document.createElement("asip-plot").begin(this.series, title, title.replaceAll(" ", "-"), kept, first));
  }

  make_lamp() { this.body.append((this.light = h("span", { class: "bulb unknown" })), (this.text = h("span", { class: "big" }))); }

  make_switch() {
    this.button = h("button", { class: "toggle", role: "switch", "aria-checked": "false",
      onclick: () => this.send(!this.on) }, h("span", { class: "knob" }));
    this.text = h("span", { class: "big" });
    this.body.append(this.button, this.text);
  }

  make_slider() {
    const { min, max, step } = range_of(this.property) ?? { min: 0, max: 100, step: 1 };
    this.text = h("span", { class: "big" });
    this.input = h("input", { type: "range", min, max, step, class: "unknown",
      oninput: () => this.slide(), onchange: () => this.slide() });
    this.input.value = (min + max) / 2;
    this.body.append(this.text, this.input);
  }

  make_stop() {
    this.button = h("button", { class: "stop", title: status.you.resume ? t("brings-every-board") : t("brings-every"),
      onclick: () => this.send(undefined) }, title_of(this.widget, this.property));
    this.body.append(this.button);
  }

  make_gauge() {
    const arc = (name) => svg("path", { class: name, d: "M10 50A40 40 0 0 1 90 50", pathLength: 100 });
    this.text = h("span", { class: "big" });
    this.bounds = small();
    this.body.append(svg("svg", { viewBox: "0 0 100 55", "aria-hidden": "true" }, arc("gauge-all"), (this.arc = arc("gauge-part"))), this.text, this.bounds);
  }

  make_text() { this.body.append(h("p", { class: "words" }, this.widget.text)); }

  /// {state, reason} of its board.
  board_is(board) {
    this.board = board;
    if (this.isConnected) this.show_title();
    this.show();
  }

  says({ value, at }) {
    this.value = value;
    this.at = time_of(at) ?? Date.now();
    if (this.series && typeof value === "number") this.series.add(this.at, [this.point(value)]);
    this.show();
  }

  point(value) { return { key: "value", name: title_of(this.widget, this.property), value, unit: this.property?.unit }; }

  /// Points of a plot from before it was looked at, the newest first.
  past(points) {
    for (const [at, value] of points.slice().reverse()) this.series?.add(time_of(at), [this.point(value)]);
  }

  show() {
    if (!this.isConnected) return;
    const { widget, value } = this;
    const trouble = trouble_of(widget, this.board, this.property);
    const stopped = this.board?.reason === "latched" && trouble === "" && ["switch", "slider"].includes(widget.kind);
    this.text?.classList.toggle("unknown-text", value === undefined);
    set_text(this.trouble, stopped ? t("board-board-stopped", { board: widget.board }) : trouble);
    this.classList.toggle("gone", trouble !== "" && widget.kind !== "stop");
    for (const control of [this.button, this.input]) if (control) control.disabled = !this.may[widget.kind === "stop" ? "stop" : "use"] || trouble !== "" || Boolean(stopped);
    if (!this.sliding) this[`show_${widget.kind}`]?.(value); // what a person moves stays where it is
  }

  show_value(value) {
    set_text(this.text, value_text(this.property, value) || "–");
    const age = Date.now() - this.at;
    set_text(this.age, age > kOldMs ? t("age-ago", { age: duration_text(age) }) : "");
  }

  show_plot(value) { set_text(this.text, value_text(this.property, value) || "–"); }

  two_words(value) {
    const on = is_on(value);
    if (on === undefined || typeof value === "boolean") return value_text(this.property, value) || t("not-known");
    return on ? t("on") : t("off");
  }

  show_gauge(value) {
    this.show_plot(value);
    const { min = 0, max = 1, unit } = this.property ?? {};
    const part = typeof value === "number" ? Math.min(1, Math.max(0, (value - min) / (max - min))) : 0;
    this.arc.setAttribute("stroke-dasharray", `${100 * part} 200`);
    set_text(this.bounds, this.property ? t("min-max", { min: with_unit(min, unit), max: with_unit(max, unit) }) : "");
  }

  show_lamp(value) {
    const on = is_on(value);
    this.light.className = `bulb ${on === undefined ? "unknown" : on ? "on" : "off"}`;
    set_text(this.text, this.two_words(value));
  }

  show_switch(value) {
    this.on = is_on(value) ?? false;
    this.button.setAttribute("aria-checked", String(this.on));
    this.button.classList.toggle("unknown", value === undefined);
    set_text(this.text, this.two_words(value));
  }

  show_slider(value) {
    const place = place_in(value);
    set_text(this.text, value === undefined ? t("not-known") : value_text(this.property, value));
    this.input.classList.toggle("unknown", place === undefined);
    if (place !== undefined) this.input.value = place;
  }

  /// The newest place of a slider is sent, and none waits behind it.
  async slide() {
    set_text(this.text, value_text(this.property?.kind === "number" ? this.property : undefined, Number(this.input.value)));
    this.again = true;
    if (this.sliding) return;
    this.sliding = true;
    while (this.again && this.isConnected) {
      this.again = false;
      await this.send(Number(this.input.value));
      await new Promise((done) => setTimeout(done, kSlideMs));
    }
    this.sliding = false;
  }

  // What it shows then comes from the bus, as the board's agent says.
  async send(value) {
    try {
      const body = value === undefined ? {} : { value };
      const answer = await this.ask(body);
      if (this.widget.kind === "stop") this.tell(...stopped_text(answer));
      else this.tell("", "");
    } catch (problem) {
      this.tell("refused", problem.message);
      this.show();
    }
  }
}

function stopped_text(answer) {
  const boards = Object.entries(answer?.boards ?? {});
  const failed = boards.filter(([, each]) => each.status !== "ok").map(([name]) => name);
  if (failed.length > 0) return ["timeout", `${t("stopped-but", { failed: failed.join(", ") })}.`];
  return boards.length === 0 ? ["refused", t("no-board-dashboard")] : ["ok", `${t("stopped")}.${status.you.resume ? ` ${t("commands-refused")}` : ""}`]; // a link resumes none
}

customElements.define("asip-widget", Widget);
