// SPDX-License-Identifier: Apache-2.0
// Who may do what: users of the tokens file, and the links of dashboards, which are ended here.
import { t } from "../core/language.js";
import { moment_text, role_text, time_of, who_text } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { answer_line, command_line, h, muted, page_of, Part, set_text, small } from "./dom.js";
import { boards, status } from "./model.js";

const until_text = (until) => (until ? t("until-until", { until: moment_text(time_of(until)) }) : t("without-end"));
const part = (name, list) => list && `${name}: ${list.join(", ")}`;

class Access extends Part {
  shown() {
    this.users = h("ul", { class: "link-list" });
    this.note = muted();
    this.links = h("ul", { class: "link-list" });
    this.link_note = muted();
    this.answer = answer_line();
    this.how = h("details", {}, h("summary", {}, t("make-end")), muted(t("token-made")),
      command_line("sudo asip-gateway token operator NAME --tokens /etc/asip/tokens"),
      muted(t("ends-every")),
      command_line("sudo sed -i '/ NAME /d' /etc/asip/tokens"));
    this.append(h("h3", {}, t("users")), this.note, this.users, this.how, h("h3", {}, t("links-dashboards")), this.link_note, this.links, this.answer);
    this.listen(status, "change", () => this.show());
    this.listen(boards, "dashboards", () => this.load());
    this.show();
    this.load();
  }

  show() {
    const { users } = status.now ?? {};
    const key = JSON.stringify([users, status.you.role]);
    if (key === this.key) return;
    this.key = key;
    this.how.hidden = status.you.role !== "admin";
    set_text(this.note, !users ? t("admin-sees") : users.length === 0 ? t("nobody-token") : "");
    this.users.replaceChildren(...(users ?? []).map((each) => h("li", {}, h("span", {}, each.name), " ",
      small([role_text(each.role), part(t("boards"), each.boards), part(t("services"), each.services), each.dashboard && t("dashboard-dashboard", { dashboard: each.dashboard }), until_text(each.until)].filter(Boolean).join(", ")))));
  }

  async load() {
    const { items = [] } = await request("api/dashboards").catch(() => ({}));
    const links = items.flatMap((dashboard) => (dashboard.links ?? []).map((each) => ({ dashboard, ...each })));
    set_text(this.link_note, links.length > 0 ? "" : t("there-none"));
    this.links.replaceChildren(...links.map((each) => h("li", {}, h("a", { href: page_of("dashboard", each.dashboard.name) }, each.dashboard.title || each.dashboard.name), " ",
      small([each.name, each.control ? t("may-use") : t("looks-only"), until_text(each.until), each.by && t("made", { by: who_text(each.by) })].filter(Boolean).join(", ")), " ",
      h("button", { "aria-label": t("end-each", { each: each.name, title: each.dashboard.title || each.dashboard.name }), onclick: () => this.end_link(each) }, t("end")))));
  }

  async end_link({ dashboard, name }) {
    try {
      await request(path_of("dashboards", dashboard.name, "links", name), { method: "DELETE", body: {} });
      set_text(this.answer, "");
    } catch (problem) {
      this.answer.className = "answer refused";
      set_text(this.answer, problem.message);
    }
    await this.load();
  }
}

customElements.define("asip-access", Access);
