// SPDX-License-Identifier: Apache-2.0
// Links that show one dashboard to each person who has them, and nothing else.
import { t } from "../core/language.js";
import { moment_text, time_of, who_text } from "../core/text.js";
import { base, path_of, request } from "../net/bus.js";
import { answer_line, field, fresh_id, h, muted, Part, small } from "./dom.js";

const periods = [["1h", t("one-hour")], ["1d", t("one-day")], ["7d", t("week")], ["30d", t("30-days")], ["365d", t("year")], ["", t("until-ended")]];

class Share extends Part {
  shown() {
    this.list = h("ul", { class: "link-list" });
    const until = h("select", { id: fresh_id("until") }, periods.map(([value, text]) => h("option", { value }, text)));
    until.value = "30d";
    const control = h("input", { id: fresh_id("control"), type: "checkbox" });
    this.answer = answer_line();
    this.made = h("p", { class: "made-link", hidden: true });
    this.box = h("details", { ontoggle: () => { if (this.box.open) this.load(); } }, h("summary", {}, t("share")),
      muted(t("user-link")),
      h("form", { "aria-label": t("share-dashboard"), onsubmit: (event) => { event.preventDefault(); this.make(until.value, control.checked); } },
        field(t("valid"), until),
        h("label", { class: "check" }, control, " ", t("switches-sliders")),
        h("span", { class: "actions" }, h("button", { class: "main" }, t("make-share")))), this.made, this.list, this.answer);
    this.append(this.box);
  }

  async make(until, control) {
    try {
      const link = await request(path_of("dashboards", this.name, "links"), { method: "POST", body: { control, until: until || null } });
      const address = new URL(`kiosk/${link.token}/`, base).href;
      const shown = h("input", { type: "text", readonly: true, value: address, "aria-label": t("the-link"), onfocus: () => shown.select() });
      const local = ["localhost", "127.0.0.1", "[::1]"].includes(location.hostname);
      this.made.replaceChildren(shown, " ", h("button", { onclick: () => navigator.clipboard?.writeText(address) }, t("copy")), " ", h("a", { href: address, target: "_blank", rel: "noreferrer" }, t("open")),
        h("br", {}), small(`${t("not-shown")}${local ? ` ${t("works-machine")}` : ""}`));
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
      small([each.control ? t("may-use") : t("looks-only"), each.until ? t("until-until", { until: moment_text(time_of(each.until)) }) : t("without-end"), each.by && t("made", { by: who_text(each.by) })].filter(Boolean).join(", ")), " ",
      h("button", { "aria-label": t("end-each-within", { each: each.name }), onclick: () => this.end_link(each.name) }, t("end")))));
  }

  async end_link(name) {
    try {
      await request(path_of("dashboards", this.name, "links", name), { method: "DELETE", body: {} });
    } catch (problem) {
      this.tell("refused", problem.message);
    }
    await this.load();
  }
}

customElements.define("asip-share", Share);
