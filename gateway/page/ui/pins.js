// SPDX-License-Identifier: Apache-2.0
// The pins of a board, drawn as the board has them. A click on a free pin shows what it can do.
import { answer_text } from "../core/form.js";
import { known_text, t } from "../core/language.js";
import { board_rows, mode_names, pins_of, PinValues, settable_modes } from "../core/pins.js";
import { is_simple } from "../core/properties.js";
import { first_up, service_text, word_text, words } from "../core/text.js";
import { offers_of_board } from "./add_widget.js";
import { bus } from "../net/bus.js";
import { answer_line, before_picture, field, fresh_id, h, Part, set_class, set_text, small, tell } from "./dom.js";
import { status } from "./model.js";
import { keep_labels } from "./names.js";
import "./widget.js";

const short = { unallocated: "", input: t("in"), "input-pullup": `${t("in")} ↑`, output: t("out"), analog: `A ${t("in")}`, pwm: "PWM", reserved: "", "other-service": "", invalid: "" };
const kinds = [t("digital"), t("analog"), "PWM"];
const classes = ["button", "door", "window", "motion", "occupancy", "moisture", "smoke", "vibration", "light", "plug", "relay", "fan", "pump", "heater", "buzzer"]; // of meanings

const mode_text = (mode) => known_text(`mode.${mode}`) ?? words(mode ?? "").toLowerCase();

class Pins extends Part {
  /// Call before it is put into the page, and again for a new description. What is on the screen is built anew only where
  /// the board has other pins: a user who is at a button stays there.
  begin(board, description) {
    const pins = pins_of(description);
    const same = this.pins && shape_of(pins) === shape_of(this.pins);
    this.values ??= new PinValues();
    Object.assign(this, { board, pins });
    if (!this.isConnected) return this;
    if (!same) this.build();
    for (const pin of pins) this.cells.get(pin.number).pin = pin;
    this.refresh();
    return this;
  }

  shown() {
    this.refresh = before_picture(() => this.draw());
    this.may_command = status.may_command;
    this.may_label = status.may_label;
    this.listen(status, "change", () => this.allow());
    this.build();
  }

  /// What a pin can be set to is shown to users who may set it.
  allow() {
    if (this.may_command === status.may_command && this.may_label === status.may_label) return;
    this.may_command = status.may_command;
    this.may_label = status.may_label;
    if (this.opened !== undefined) this.open_panel();
    this.refresh();
  }

  build() {
    this.cells = new Map();
    const draw_pin = (pin) => {
      const cell = { pin, name: h("span", { class: "pin-name" }, h("span", { class: "hidden" }, t("pin"), " "), pin.label), called: h("span", { class: "pin-called" }), light: h("span", { class: "light" }), text: h("span", { class: "pin-text" }), more: h("span", { class: "hidden" }) };
      cell.name.append(cell.called);
      cell.button = h("button", { class: "pin", "aria-expanded": "false", onclick: () => this.open(pin) }, cell.name, " ", cell.light, cell.text, cell.more);
      this.cells.set(pin.number, cell);
      return cell.button;
    };
    const rows = board_rows(this.pins).map((row) => h("div", { class: "pin-row" }, row.map((group) => h("div", { class: "pin-group" }, group.map(draw_pin)))));
    this.panel = h("div", { class: "pin-panel", role: "region", "aria-label": t("pin"), hidden: true });
    this.map = h("div", { class: "pcb" }, rows);
    this.all_button = h("button", { class: "all-pins", onclick: () => { this.all = !this.all; this.draw(); } });
    this.replaceChildren(this.map, this.all_button, this.panel);
    if (this.opened !== undefined && this.cells.has(this.opened)) this.open_panel();
    this.draw();
  }

  /// The list of the board, and how its properties stand.
  stands(properties, values) {
    this.values ??= new PinValues();
    this.values.stands(properties, values);
    this.refresh?.();
  }

  /// {state, reason} of its board.
  board_is(state) {
    this.state = state;
    this.refresh?.();
  }

  draw() {
    for (const { pin, button, light, called, text: said, more } of this.cells.values()) {
      const { mode, text, level: known, told, floating } = this.values.state_of(pin);
      const [value, level] = floating ? ["", undefined] : [text, known];
      const taken = pin.owner !== "";
      set_text(called, pin.name);
      set_text(said, taken ? word_text(pin.owner) : value || short[mode] || "");
      const idle = pin.number !== this.opened && (pin.owner === "system" || (!taken && !pin.name && !this.values.properties.has(pin.number)));
      set_class(button, `pin${taken ? " taken" : ""}${idle ? " idle" : ""}${pin.number === this.opened ? " open" : ""} ${mode ?? ""}`);
      set_class(light, `light ${level === undefined ? "unknown" : level > 0 ? "on" : "off"}${told ? " told" : ""}`);
      light.style.opacity = level > 0 ? String(0.35 + 0.65 * level) : "";
      const now = this.standing_of(pin, mode, value && (told ? t("set-value", { value }) : value));
      set_text(more, `, ${now}`);
      const title = `${t("pin-label", { label: pin.label })}${pin.name && ` (${pin.name})`}: ${now}`;
      if (button.title !== title) button.title = title;
      button.setAttribute("aria-expanded", String(pin.number === this.opened));
    }
    const used = this.map.querySelectorAll(".pin:not(.idle)").length;
    set_class(this.map, `pcb${this.pins.some((pin) => pin.name) ? " named" : ""}${this.all ? "" : " few"}`);
    this.map.hidden = used === 0 && !this.all;
    this.all_button.setAttribute("aria-expanded", String(Boolean(this.all)));
    set_text(this.all_button, this.all ? t("only-pins") : t("all-pins-pins", { pins: this.pins.length }));
    if (this.opened !== undefined) this.show_panel();
  }

  standing_of(pin, mode, value) {
    if (pin.owner === "system") return t("used-board-itself");
    if (pin.owner !== "") return t("belongs-owner", { owner: service_text(pin.owner) });
    return `${t("free-within")}, ${mode_text(mode)}${value ? `, ${value}` : ""}`;
  }

  open(pin) {
    this.opened = this.opened === pin.number ? undefined : pin.number;
    this.panel.hidden = this.opened === undefined;
    if (this.opened !== undefined) this.open_panel();
    this.draw();
  }

  open_panel() {
    const { pin } = this.cells.get(this.opened);
    this.panel.hidden = false;
    this.panel.setAttribute("aria-label", t("pin-label", { label: pin.label }));
    this.state_line = h("span", {});
    this.output = answer_line();
    this.panel.replaceChildren(h("h3", {}, t("pin-label", { label: pin.label }), " ", (this.panel_note = small())), h("p", {}, this.state_line));
    this.mode_buttons = new Map();
    this.controls = h("div", { class: "setters" });
    if (pin.owner === "" && this.may_command) this.add_modes(pin);
    if (this.may_label) this.panel.append(this.meaning_form(pin));
    const offers = () => offers_of_board(this.board, (each) => each.id === `io/${pin.number}`);
    if (pin.owner === "") this.panel.append(document.createElement("asip-add-widget").begin(t("pin-label-within", { label: pin.label }), offers));
  }

  add_modes(pin) {
    for (const mode of settable_modes(pin)) {
      this.mode_buttons.set(mode, h("button", { onclick: () => this.send("mode", { pin: pin.number, mode }) }, first_up(mode_text(mode))));
    }
    this.panel.append(h("div", { class: "chips", role: "group", "aria-label": t("mode-pin", { label: pin.label }) }, [...this.mode_buttons.values()]), this.controls, this.output);
    this.controls_for = undefined;
  }

  /// What people call the pin, and what it is: the board's agent keeps both.
  meaning_form(pin) {
    const id = `io/${pin.number}`;
    const meaning = this.values.properties.get(pin.number)?.property.meaning ?? {};
    const klass = meaning.class ?? "";
    const inverted = String(meaning.inverted ?? "");
    const name = h("input", { id: fresh_id("pin-name"), type: "text", maxlength: 63, autocomplete: "off", value: pin.name, placeholder: t("status-lamp") });
    const select = (title, choices, value) => {
      const element = h("select", { id: fresh_id("pin") }, choices.map(([each, text]) => h("option", { value: each }, text)));
      element.value = value;
      return [element, field(title, element)];
    };
    const [what, what_field] = select(t("is"), [["", t("whatever-mode")], ...classes.map((each) => [each, t(`class.${each}`)])], klass);
    const [turned, turned_field] = select(t("when"), [["", t("usual")], ["false", t("high")], ["true", t("low")]], inverted);
    const icon = h("input", { id: fresh_id("pin-icon"), type: "text", maxlength: 63, autocomplete: "off", value: meaning.icon ?? "", placeholder: "mdi:lamp" });
    const answer = answer_line();
    const save = async (event) => {
      event.preventDefault();
      const change = { names: { pins: { [pin.number]: name.value.trim() || null } } };
      if (what.value !== klass || turned.value !== inverted || icon.value.trim() !== (meaning.icon ?? "")) {
        change.meanings = { [id]: { class: what.value || null, inverted: turned.value === "" ? null : turned.value === "true", icon: icon.value.trim() || null } };
      }
      const { kind, text } = await keep_labels(this.board, change);
      tell(answer, kind, text);
    };
    return h("form", { class: "pin-name-form", "aria-label": t("name-pin", { label: pin.label }), onsubmit: save },
      field(t("name-within"), name, "text"), what_field, turned_field,
      field(t("icon"), icon, "text"), h("button", {}, t("save")), answer);
  }

  show_panel() {
    const { pin } = this.cells.get(this.opened);
    const { mode, text, told } = this.values.state_of(pin);
    const { property, value } = this.values.properties.get(pin.number) ?? {};
    set_text(this.panel_note, [pin.name, kinds.filter((_, bit) => pin.can & (1 << bit)).join(", ") || t("no-use-known")].filter(Boolean).join(", "));
    const owner = first_up({ "": t("free-within"), system: t("used-board-itself") }[pin.owner] ?? t("belongs-owner", { owner: service_text(pin.owner) }));
    set_text(this.state_line, [owner, mode && pin.owner === "" ? t("mode-mode", { mode: mode_text(mode) }) : "", text && (told ? t("set-value", { value: text }) : t("now-text", { text }))].filter(Boolean).join(", ") + "."
      + (property?.refused ? ` ${t("cannot-set", { refused: property.refused })}` : ""));
    if (pin.owner !== "") return;
    for (const [each, button] of this.mode_buttons) button.setAttribute("aria-pressed", String(each === mode));
    const key = property && !property.refused && this.may_command && is_simple(property) ? JSON.stringify(property) : "";
    if (this.controls_for !== key) {
      this.controls_for = key;
      this.controls.replaceChildren(key && document.createElement("asip-widget").sets(this.board, property, { use: true }));
    }
    const [setter] = this.controls.children;
    if (setter && this.state) setter.board_is(this.state);
    setter?.says({ value });
  }

  async send(command, args) {
    this.output.className = "answer";
    set_text(this.output, t("waiting-board"));
    const { output } = this;
    const answer = await bus.command(this.board, "io", command, args).answer;
    const { kind, text } = answer_text(answer);
    tell(output, kind, text);
  }
}

function shape_of(pins) { return JSON.stringify(pins.map((pin) => ({ ...pin, mode: undefined, name: undefined }))); }

export function has_pins(description) { return pins_of(description).length > 0; }
export { mode_names };
customElements.define("asip-pins", Pins);
