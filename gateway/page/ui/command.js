// SPDX-License-Identifier: Apache-2.0
// A form for one command, made from the model of its service.
import { answer_text, arguments_of, button_text, fields_of, hint_of, parse_field, safe_form, why_text } from "../core/form.js";
import { t } from "../core/language.js";
import { argument_text, choice_text, title_text, unit_text, words } from "../core/text.js";
import { bus } from "../net/bus.js";
import { answer_line, fresh_id, h, Part, set_text } from "./dom.js";
import { status } from "./model.js";

const kHoldMs = 500;
const kRenewMs = 150;
const kNewestMs = 100; // while held, a moved slider is sent at most so often
const last_values = new Map(); // "BOARD/SERVICE/COMMAND" -> entered values of the last one that was executed

class Command extends Part {
  /// Call before it is put into the page. `ask`: what sends its arguments elsewhere than to this board, and gives the answer.
  begin(board, service, model, name, ask = undefined) {
    Object.assign(this, { board, service, model, name, ask, command: model.commands[name] });
    this.fields = fields_of(this.command, model, service);
    this.key = `${board}/${service.name}/${name}`;
    return this;
  }

  shown() {
    const title = this.command.title ? title_text(this.command.title) : words(this.name);
    this.inputs = new Map();
    this.answer = answer_line();
    this.actions = h("span", { class: "actions" }, this.buttons());
    this.form = h("form", { "aria-label": `${this.service.name}: ${title}`, novalidate: true, class: this.fields.length === 0 ? "bare" : "", onchange: () => this.name_button(),
      onsubmit: (event) => { event.preventDefault(); this.send(); } },
      h("div", { class: "title" }, h("span", { class: this.says_all(title) ? "hidden" : "" }, title), this.answer), this.fields.map((field) => this.control(field)), this.actions);
    this.name_button();
    this.append(this.form);
  }

  /// The button says what the title says.
  says_all(title) { return this.fields.length === 0 && !this.held_kind && title === button_text(this.command, this.name, this.model.element); }

  get held_kind() { return this.command.safe !== undefined && !this.ask; }
  /// The model says so: it moves something, and runs only while its button is down.
  get runs_while_held() { return this.held_kind && this.command.hold === true; }

  buttons() {
    const first = this.runs_while_held;
    const set = h("button", first ? { title: t("stays-when") } : { class: "main" }, first ? t("keep-on") : "");
    this.name_button = () => { if (!first) set_text(set, button_text(this.command, this.name, this.model.element, this.inputs.get(this.model.element)?.value())); };
    if (!this.held_kind) return set;
    const hold = h("button", { type: "button", class: first ? "main hold" : "hold", "aria-pressed": "false",
      title: t("works-long"),
      onpointerdown: (event) => { hold.setPointerCapture(event.pointerId); this.hold(hold); },
      onpointerup: () => this.release(), onpointercancel: () => this.release(), onlostpointercapture: () => this.release(),
      onkeydown: (event) => { if (is_press(event)) { event.preventDefault(); if (!event.repeat) this.hold(hold); } },
      onkeyup: (event) => { if (is_press(event)) this.release(); },
      onblur: () => this.release(), oncontextmenu: (event) => event.preventDefault() }, first ? t("hold-run") : t("hold"));
    this.listen(document, "visibilitychange", () => this.release());
    this.while_shown(() => this.release());
    return first ? [hold, set] : [set, hold];
  }

  control(field) {
    const id = fresh_id("field");
    const label = h("label", { for: id }, argument_text(field.name), field.unit ? h("span", { class: "muted" }, ` ${unit_text(field.unit)}`) : "");
    const known = last_values.get(this.key)?.[field.name];
    const input = makers[field.kind]?.(this, field, id, known) ?? make_number(this, field, id, known);
    this.inputs.set(field.name, input);
    return h("div", { class: `field ${field.kind}${field.preset === undefined ? "" : " element"}` }, label, input.elements);
  }

  entered() { return Object.fromEntries([...this.inputs].map(([name, input]) => [name, input.value()])); }

  /// The arguments; undefined, with a sentence shown, where something is not right.
  arguments() {
    const { args, error, field } = arguments_of(this.fields, this.entered());
    for (const [name, input] of this.inputs) input.focusable.setAttribute("aria-invalid", name === field);
    if (error) this.tell("refused", `${error}.`);
    return args;
  }

  /// A slider was released: sent at once where everything else is known. While one is under way only the newest waits.
  async slid() {
    if (this.runs_while_held || this.held) return;
    const { args } = arguments_of(this.fields, this.entered());
    if (!args) return;
    if (this.busy) return void (this.again = true);
    await this.send();
    if (this.again) {
      this.again = false;
      this.slid();
    }
  }

  async send() {
    const args = this.arguments();
    if (!args) return [...this.inputs.values()].find((input) => input.focusable.getAttribute("aria-invalid") === "true")?.focusable.focus();
    this.busy = true;
    const waiting = setTimeout(() => this.tell("", t("waiting-board")), 150);
    const began = performance.now();
    const entered = this.entered();
    const answer = await (this.ask?.(args) ?? bus.command(this.board, this.service.name, this.name, args).answer);
    clearTimeout(waiting);
    this.busy = false;
    if (answer.status === "ok") last_values.set(this.key, entered);
    this.finished(answer, args, performance.now() - began);
  }

  finished(answer, args, ms) {
    if (this.ask) return this.tell(answer.kind, answer.text);
    const { kind, text } = answer_text(answer);
    this.tell(kind, text);
    if (answer.status !== "ok") return;
    const proof = `${this.service.name} ${this.name}: ${answer.proof}${ms === undefined ? "" : `, ${Math.round(ms)} ms`}`;
    this.dispatchEvent(Object.assign(new Event("proof", { bubbles: true }), { proof }));
  }

  hold(button) {
    if (this.held || !status.may_command) return;
    const args = this.arguments();
    if (!args) return;
    button.setAttribute("aria-pressed", "true");
    this.held = { button, args: undefined, at: 0 };
    this.send_held(args);
    this.held.timer = setInterval(() => this.renew(), kRenewMs);
  }

  renew() {
    const { held } = this;
    const { args } = arguments_of(this.fields, this.entered());
    if (args && JSON.stringify(args) !== JSON.stringify(held.args) && performance.now() - held.at >= kNewestMs) return this.send_held(args);
    if (held.begun) held.sent.renew((answer) => this.lost(held, answer)); // before that there is nothing to renew
    return undefined;
  }

  lost(held, answer) {
    if (this.held !== held) return;
    this.release(false);
    this.tell("timeout", t("not-held", { why: why_text(answer) }));
  }

  async send_held(args) {
    const { held } = this;
    if (held.begun) held.sent.release();
    const sent = bus.command(this.board, this.service.name, this.name, args, { hold_ms: kHoldMs });
    Object.assign(held, { args, sent, at: performance.now(), begun: false });
    const answer = await sent.answer;
    const current = this.held === held && held.sent === sent;
    if (answer.status !== "ok") {
      this.finished(answer, args);
      if (current) this.release(false);
      return;
    }
    if (!current) return;
    held.begun = true;
    last_values.set(this.key, this.entered());
    this.tell("ok", t("held"));
  }

  /// Made safe at once; should that be lost on its way, the agent does it by itself within the hold time.
  async release(make_safe = true) {
    const { held } = this;
    if (!held) return;
    this.held = undefined;
    clearInterval(held.timer);
    if (held.begun) held.sent.release();
    held.button.setAttribute("aria-pressed", "false");
    const safe = safe_form(this.model, this.name, held.args);
    if (!make_safe || !safe) return;
    const answer = await bus.command(this.board, this.service.name, safe.command, safe.args).answer;
    const { kind, text } = answer.status === "ok" ? { kind: "ok", text: t("let-go-safe") } : answer_text(answer);
    if (!this.held && this.isConnected) this.tell(kind, text);
  }
}

function is_press(event) { return event.key === " " || event.key === "Enter"; }

function make_number(form, field, id, known = field.preset) {
  const hint = hint_of(field);
  const number = h("input", { id, type: "number", inputmode: field.min < 0 ? "text" : "numeric", min: field.min, max: field.max,
    step: field.kind === "integer" ? 1 : "any", placeholder: hint, value: known });
  const value = () => number.value;
  if (!field.slider) return { elements: [number], focusable: number, value };
  const slider = h("input", { type: "range", min: field.min, max: field.max, step: field.kind === "integer" ? 1 : (field.max - field.min) / 1000,
    "aria-label": `${argument_text(field.name)}, ${hint}`, onchange: () => form.slid() });
  const show = (text) => {
    slider.value = text;
    slider.classList.remove("unknown");
    slider.removeAttribute("aria-valuetext");
  };
  number.addEventListener("input", () => { if (!parse_field(field, number.value).error) show(number.value); });
  slider.addEventListener("input", () => {
    number.value = slider.value;
    show(slider.value);
  });
  if (known !== undefined) {
    show(known);
  } else {
    // Not known yet: the slider must not look as if this were the present value.
    slider.classList.add("unknown");
    slider.setAttribute("aria-valuetext", t("not-known"));
    slider.value = (field.min + field.max) / 2;
  }
  return { elements: [slider, number], focusable: number, value };
}

function make_choice(form, field, id, known) {
  const options = field.choices.map(({ value, name }) => h("option", { value }, choice_text(name)));
  const select = h("select", { id }, options);
  const preset = known ?? field.preset;
  if (preset === undefined) select.prepend(h("option", { value: "" }, t("choose")));
  select.value = preset ?? "";
  return { elements: [select], focusable: select, value: () => select.value };
}

function make_text(form, field, id, known) {
  const input = h("input", { id, type: "text", maxlength: field.max_length, placeholder: hint_of(field), value: known, autocomplete: "off" });
  return { elements: [input], focusable: input, value: () => input.value };
}

function make_color(form, field, id, known) {
  const input = h("input", { id, type: "color", value: known ?? "#ffffff" });
  return { elements: [input], focusable: input, value: () => input.value };
}

function make_list(form, field, id) {
  const rows = [];
  const list = h("div", { class: "list", role: "group", "aria-label": argument_text(field.name) });
  const add = h("button", { id, type: "button", onclick: () => append() }, t("add"));
  const append = () => {
    const parts = field.items.map((item) => {
      const part_id = fresh_id("field");
      const input = makers[item.kind]?.(form, item, part_id) ?? make_number(form, { ...item, slider: false }, part_id);
      return { input, element: h("span", { class: "part" }, h("label", { for: part_id, class: field.items.length === 1 ? "hidden" : "" }, argument_text(item.name)), input.elements) };
    });
    const remove = h("button", { type: "button", "aria-label": t("remove-name", { name: `${argument_text(field.name)} ${rows.length + 1}` }), onclick: () => {
      rows.splice(rows.indexOf(row), 1);
      row.element.remove();
      add.disabled = false;
    } }, "×");
    const row = { parts, element: h("div", { class: "list-row" }, parts.map((part) => part.element), remove) };
    rows.push(row);
    list.insertBefore(row.element, add);
    if (rows.length >= field.max_length) add.disabled = true;
  };
  list.append(add);
  append();
  return { elements: [list], focusable: add, value: () => rows.map((row) => row.parts.map((part) => part.input.value())) };
}

const makers = { choice: make_choice, text: make_text, color: make_color, list: make_list };

customElements.define("asip-command", Command);
