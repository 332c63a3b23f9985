// SPDX-License-Identifier: Apache-2.0
// "Add to dashboard": beside a service and a pin on a board's page, and in the editor of a dashboard.
import { name_of_title, offers_of } from "../core/dashboard.js";
import { t } from "../core/language.js";
import { path_of, properties_of, request, request_with_tag } from "../net/bus.js";
import { answer_line, field, fresh_id, h, muted, page_of, Part } from "./dom.js";
import { status } from "./model.js";

const kTries = 3;
let last_dashboard; // added to last, by this tab

/// What of a board can be added; `wanted`: of which properties.
export async function offers_of_board(board, wanted = () => true) {
  return offers_of(board, (await properties_of(board)).filter(wanted));
}

/// Adds a widget to a dashboard that may be changed by another user at the same moment; `fresh`: to one that is not there yet.
async function add_to_dashboard(name, title, widget, fresh) {
  for (let i = 0; ; ++i) {
    const found = fresh && i === 0 ? { body: { title, widgets: [] }, tag: undefined } : await request_with_tag(path_of("dashboards", name));
    const { widgets } = found.body;
    try {
      return await request(path_of("dashboards", name), { method: "PUT", body: { title: found.body.title, widgets: [...widgets, widget] },
        headers: found.tag ? { "If-Match": found.tag } : { "If-None-Match": "*" } });
    } catch (problem) {
      if (i + 1 >= kTries || ![409, 412].includes(problem.status)) throw problem;
    }
  }
}

class AddWidget extends Part {
  /// Call before it is put into the page. `offers`: a function that gives what can be added, now; `what`: for people who cannot see it.
  /// With `done` it is open, and that is called with the dashboard; `title`: of a new one.
  begin(what, offers, { title = "", done } = {}) {
    Object.assign(this, { what, offers, title, done });
    return this;
  }

  shown() {
    this.button = h("button", { class: "add-widget", "aria-expanded": "false", title: t("add-what", { what: this.what }), onclick: () => this.toggle() }, t("dashboard"), " ", h("span", { class: "hidden" }, t("with-what", { what: this.what })));
    this.panel = h("div", { class: "add-panel", hidden: true });
    this.append(this.button, this.panel);
    this.listen(status, "change", () => this.allow());
    this.allow();
    this.button.hidden = Boolean(this.done);
    if (this.done) this.toggle();
  }

  allow() { this.hidden = status.you.arrange !== true; }

  async toggle() {
    const open = this.panel.hidden;
    this.panel.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
    if (!open) return;
    this.panel.replaceChildren(muted(t("looking-what")));
    try {
      const [offers, dashboards] = await Promise.all([this.offers(), request("api/dashboards")]);
      this.show(offers, dashboards.items);
    } catch (problem) {
      this.panel.replaceChildren(h("p", { class: "answer refused" }, problem.message));
    }
  }

  show(offers, dashboards) {
    if (offers.length === 0) return this.panel.replaceChildren(muted(t("nothing-here")));
    const what = h("select", { id: fresh_id("what") }, offers.map((offer, i) => h("option", { value: i }, offer.text)));
    const where = h("select", { id: fresh_id("where"), onchange: () => { fresh.hidden = where.value !== ""; } },
      dashboards.map((each) => h("option", { value: each.name }, each.title || each.name)), h("option", { value: "" }, t("new-dashboard")));
    if (dashboards.some((each) => each.name === last_dashboard)) where.value = last_dashboard;
    const title = h("input", { id: fresh_id("title"), type: "text", maxlength: 60, value: this.title || offers[0].widget.board, placeholder: t("title-such"), autocomplete: "off" });
    const fresh = h("div", { class: "field text", hidden: where.value !== "" }, h("label", { for: title.id }, t("title-new")), title);
    this.answer = answer_line();
    const save = async (event) => {
      event.preventDefault();
      await this.save(offers[Number(what.value)].widget, where.value || name_of_title(title.value), title.value.trim(), where.value === "");
    };
    this.panel.replaceChildren(h("form", { "aria-label": t("add-what", { what: this.what }), onsubmit: save },
      field(t("what"), what), field(t("to"), where), fresh,
      h("span", { class: "actions" }, h("button", { class: "main" }, t("add"))), this.answer));
    what.focus();
  }

  async save(widget, name, title, fresh) {
    if (name === "") return this.tell("refused", t("dashboard-needs"));
    try {
      await add_to_dashboard(name, title, widget, fresh);
      last_dashboard = name;
      if (this.done) return this.done(name);
      this.tell("ok", t("added"), " ", h("a", { href: page_of("dashboard", name) }, t("show-dashboard")));
    } catch (problem) {
      this.tell("refused", problem.message);
    }
  }

  tell(kind, ...text) {
    this.answer.className = `answer ${kind}`;
    this.answer.replaceChildren(...text);
  }
}

customElements.define("asip-add-widget", AddWidget);
