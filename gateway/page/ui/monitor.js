// SPDX-License-Identifier: Apache-2.0
// What goes over the line of a board, as its agent sees it: lines for people, or the bytes as they came. Loaded when it is opened.
import { Line } from "../core/line.js";
import { t } from "../core/language.js";
import { bus } from "../net/bus.js";
import { before_picture, h, Part, set_text } from "./dom.js";

class Monitor extends Part {
  shown() {
    this.line = new Line((n) => t("bytes-left-out", { n }));
    this.raw = h("input", { type: "checkbox", onchange: () => this.draw() });
    this.pause = h("input", { type: "checkbox", onchange: () => this.draw() });
    this.text = h("pre", { tabindex: "0", role: "log", "aria-label": t("serial-monitor") });
    this.append(h("p", { class: "actions" }, h("label", { class: "check" }, this.raw, " ", t("raw-bytes")), h("label", { class: "check" }, this.pause, " ", t("pause")), h("button", { onclick: () => this.clear() }, t("clear"))), this.text);
    const draw = before_picture(() => this.draw());
    let live = false; // what the gateway kept of a monitor before is old
    this.while_shown(bus.subscribe({ subscribe: `${this.name}/$line`, max_hz: 10 }, (message) => {
      if (message.event === "snapshot-end") live = true;
      if (message.event !== "value" || !live) return;
      this.line.take(message.value, Date.now());
      draw();
    }));
  }

  clear() {
    this.line.clear();
    this.draw();
  }

  draw() {
    if (this.pause.checked && this.text.textContent) return;
    const { text } = this;
    const at_end = text.scrollTop + text.clientHeight > text.scrollHeight - 8;
    set_text(text, this.line.text(this.raw.checked));
    if (at_end) text.scrollTop = text.scrollHeight;
  }
}

customElements.define("asip-monitor", Monitor);
