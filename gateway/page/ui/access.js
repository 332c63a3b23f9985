// SPDX-License-Identifier: Apache-2.0
// Who may do what: users of the tokens file, and the links of dashboards, which are ended here.
import { moment_text, time_of, who_text } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { command_line, h, Part, set_text } from "./dom.js";
import { boards, status } from "./model.js";

const until_text = (until) => (until ? `until ${moment_text(time_of(until))}` : "without an end");
const part = (name, list) => list && `${name}: ${list.join(", ")}`;

class Access extends Part {
  shown() {
    this.users = h("ul", { class: "link-list" });
    this.note = h("p", { class: "muted" });
    this.links = h("ul", { class: "link-list" });
    this.link_note = h("p", { class: "muted" });
    this.answer = h("output", { class: "answer", "aria-live": "polite" });
    this.how = h("details", {}, h("summary", {}, "Make and end tokens"), h("p", { class: "muted" }, "A token is made on the gateway's machine, and printed once:"),
      command_line("sudo asip-gateway token operator NAME --tokens /etc/asip/tokens"),
      h("p", { class: "muted" }, "It ends, with every browser that is signed in by it, when its line is taken out of the file:"),
      command_line("sudo sed -i '/ NAME /d' /etc/asip/tokens"));
    this.append(h("h3", {}, "Users"), this.note, this.users, this.how, h("h3", {}, "Links to dashboards"), this.link_note, this.links, this.answer);
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
    set_text(this.note, !users ? "An admin sees who has a token." : users.length === 0 ? "Nobody has a token: users of this machine may do everything, others what --anonymous says." : "");
    this.users.replaceChildren(...(users ?? []).map((each) => h("li", {}, h("span", {}, each.name), " ",
      h("small", { class: "muted" }, [each.role, part("boards", each.boards), part("services", each.services), each.dashboard && `dashboard: ${each.dashboard}`, until_text(each.until)].filter(Boolean).join(", ")))));
  }

  async load() {
    const { items = [] } = await request("api/dashboards").catch(() => ({}));
    const links = items.flatMap((dashboard) => (dashboard.links ?? []).map((each) => ({ dashboard, ...each })));
    set_text(this.link_note, links.length > 0 ? "" : "There is none. A dashboard's “Share” makes one.");
    this.links.replaceChildren(...links.map((each) => h("li", {}, h("a", { href: `#/dashboard/${encodeURIComponent(each.dashboard.name)}` }, each.dashboard.title || each.dashboard.name), " ",
      h("small", { class: "muted" }, [each.name, each.control ? "may use its controls" : "looks only", until_text(each.until), each.by && `made by ${who_text(each.by)}`].filter(Boolean).join(", ")), " ",
      h("button", { "aria-label": `End ${each.name} of ${each.dashboard.title || each.dashboard.name}`, onclick: () => this.end_link(each) }, "End"))));
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
