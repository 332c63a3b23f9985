// SPDX-License-Identifier: Apache-2.0
// Elements without HTML text: names and values only ever become text nodes.
import { t } from "../core/language.js";
import { state_text } from "../core/text.js";

/// h("button", { class: "plain", onclick: f, disabled: true }, "Send")
export function h(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) element.setAttribute(name, value);
  }
  element.append(...children.flat(Infinity).filter((child) => child !== undefined && child !== null && child !== false));
  return element;
}

/// The same of a picture.
export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function set_text(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function set_class(element, name) {
  if (element.className !== name) element.className = name;
}

export const muted = (...children) => h("p", { class: "muted" }, ...children);
export const small = (...children) => h("small", { class: "muted" }, ...children);
export const page_of = (kind, name) => `#/${kind}/${encodeURIComponent(name)}`;

/// A control with an id below its title.
export const field = (title, control, kind = "") => h("div", { class: `field ${kind}` }, h("label", { for: control.id }, title), control);

/// Where it is told how what a person asked for has ended.
export const answer_line = () => h("output", { class: "answer", "aria-live": "polite" });
export function tell(line, kind, text) {
  set_class(line, `answer ${kind}`);
  set_text(line, text);
}

let ids = 0;
export function fresh_id(prefix) { return `${prefix}-${++ids}`; }

/// A function that calls `work` once before the next picture, however often it is called.
export function before_picture(work) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      work();
    });
  };
}

/// An element whose listeners and timers end with it: what `while_shown` is given is called when it is taken away.
export class Part extends HTMLElement {
  #ends = [];
  /// Whose it is: a board's, a dashboard's. Call before it is put into the page.
  begin(name) {
    this.name = name;
    return this;
  }

  while_shown(end) { this.#ends.push(end); }

  listen(target, name, handler) {
    target.addEventListener(name, handler);
    this.while_shown(() => target.removeEventListener(name, handler));
  }

  every(ms, work) {
    const timer = setInterval(work, ms);
    this.while_shown(() => clearInterval(timer));
  }

  tell(kind, text) { tell(this.answer, kind, text); }

  connectedCallback() { this.shown(); }

  disconnectedCallback() {
    for (const end of this.#ends.splice(0)) end();
    this.hidden_again?.();
  }
}

/// A command that a person types on a machine, with a button that copies it.
export function command_line(text) {
  const copy = h("button", { "aria-label": t("copy-text", { text }), onclick: () => navigator.clipboard?.writeText(text).then(() => set_text(copy, t("copied")), () => undefined) }, t("copy"));
  return h("div", { class: "command-line" }, h("code", {}, text), copy);
}

export function state_mark(state) { return h("span", { class: `state ${state}` }, state_text(state)); }
