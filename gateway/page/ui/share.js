// SPDX-License-Identifier: Apache-2.0
// Links that show one dashboard to each person who has them, and nothing else.
import { moment_text, time_of, who_text } from "../core/text.js";
import { base, path_of, request } from "../net/bus.js";
import { fresh_id, h, Part, set_text } from "./dom.js";

const periods = [["1h", "one hour"], ["1d", "one day"], ["7d", "a week"], ["30d", "30 days"], ["365d", "a year"]];

class Share extends Part {
  begin(name) {
    this.name = name;
    return this;
  }

  shown() {
    this.list = h("ul", { class: "link-list" });
    const until = h("select", { id: fresh_id("until") }, periods.map(([value, text]) => h("option", { value }, text)));
    until.value = "30d";
    const control = h("input", { id: fresh_id("control"), type: "checkbox" });
    this.answer = h("output", { class: "answer", "aria-live": "polite" });
    this.made = h("p", { class: "made-link", hidden: true });
    this.box = h("details", { ontoggle: () => { if (this.box.open) this.load(); } }, h("summary", {}, "Share"),
      h("p", { class: "muted" }, "A user with the link sees this dashboard, without a token and nothing else: for a screen in the hall, or the phones of a class."),
      h("form", { "aria-label": "Share this dashboard", onsubmit: (event) => { event.preventDefault(); this.make(until.value, control.checked); } },
        h("div", { class: "field" }, h("label", { for: until.id }, "Valid for"), until),
        h("label", { class: "check" }, control, " Its switches, sliders and stops may be used"),
        h("span", { class: "actions" }, h("button", { class: "main" }, "Make a link"))), this.made, this.list, this.answer);
    this.append(this.box);
  }

  async make(until, control) {
    try {
      const link = await request(path_of("dashboards", this.name, "links"), { method: "POST", body: { control, until } });
      const address = new URL(`kiosk/${link.token}/`, base).href;
      const field = h("input", { type: "text", readonly: true, value: address, "aria-label": "The link", onfocus: () => field.select() });
      const local = ["localhost", "127.0.0.1", "[::1]"].includes(location.hostname);
      this.made.replaceChildren(field, " ", h("button", { onclick: () => navigator.clipboard?.writeText(address) }, "Copy"), " ", h("a", { href: address, target: "_blank", rel: "noreferrer" }, "Open"),
        h("br", {}), h("small", { class: "muted" }, `It is not shown again.${local ? " It works on this machine only: open this page by the address at which others reach the gateway." : ""}`));
      this.made.hidden = false;
      this.tell("", "");
      await this.load();
    } catch (problem) {
      this.tell("refused", problem.message);
    }
  }

  async load() {
    const { links = [] } = await request(path_of("dashboards", this.name)).catch(() => ({}));
    this.list.replaceChildren(...links.map((each) => h("li", {}, h("span", {}, each.name), " ",
      h("small", { class: "muted" }, [each.control ? "may use its controls" : "looks only", each.until ? `until ${moment_text(time_of(each.until))}` : "without an end", each.by && `made by ${who_text(each.by)}`].filter(Boolean).join(", ")), " ",
      h("button", { "aria-label": `End ${each.name}`, onclick: () => this.end_link(each.name) }, "End"))));
  }

  async end_link(name) {
    try {
      await request(path_of("dashboards", this.name, "links", name), { method: "DELETE", body: {} });
    } catch (problem) {
      this.tell("refused", problem.message);
    }
    await this.load();
  }

  tell(kind, text) {
    this.answer.className = `answer ${kind}`;
    set_text(this.answer, text);
  }
}

customElements.define("asip-share", Share);
