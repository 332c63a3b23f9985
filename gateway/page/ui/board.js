// SPDX-License-Identifier: Apache-2.0
// One board: its values, its controls, its pins, what it is, its history.
import { alive, label_texts } from "../core/catalogue.js";
import { firmware_text, shown_state } from "../core/firmware.js";
import { t } from "../core/language.js";
import { moves } from "../core/properties.js";
import { duration_text, moment_text, time_of, reason_text, who_text } from "../core/text.js";
import { bus, path_of, properties_of, request } from "../net/bus.js";
import { fresh_id, h, Part, set_text, small, state_mark } from "./dom.js";
import { boards, status } from "./model.js";
import "./firmware.js";
import "./history.js";
import "./links.js";
import "./names.js";
import { has_pins } from "./pins.js";
import "./service.js";
import { is_floor, is_pose } from "./world.js";

const kReloadMs = 200;
const rates = [1, 2, 5, 10, 20, 50];
let rate = 10; // values a second, kept from board to board

const rights = () => `${status.may_command} ${status.may_stop} ${status.may_forget} ${status.may_label}`;

const facts_of = (facts) => facts.filter(([, text]) => text).map(([name, text]) => h("div", {}, h("dt", {}, name), h("dd", {}, text)));

class Board extends Part {
  shown() {
    this.heading = h("h1", { tabindex: "-1" }, h("span", {}, this.name), small());
    this.mark = h("span", {});
    this.since = h("span", { class: "muted" });
    this.facts = h("dl", { class: "facts" });
    this.pins = document.createElement("asip-pins");
    this.pins_box = h("section", { class: "pins-box", "aria-label": t("pins"), hidden: true }, h("h2", {}, t("pins")));
    this.world_box = h("section", { "aria-label": t("world"), hidden: true }, h("h2", {}, t("world")));
    this.shown_services = new Map();
    this.stands = new Map(); // id of a property -> {value, how, unknown}
    this.no_service = h("p", { class: "empty", hidden: true }, t("board-offers"));
    this.values = h("section", { class: "services values-box", "aria-label": t("values") }, h("div", { class: "head-row" }, h("h2", {}, t("values")), this.rate_box()));
    this.controls = h("section", { class: "services controls-box", "aria-label": t("controls") }, h("h2", {}, t("controls")));
    this.names = document.createElement("asip-names").begin(this.name);
    this.proof = h("dd", {}, t("no-command"));
    this.deep_facts = h("dl", { class: "facts" });
    this.advanced = h("details", { class: "advanced" }, h("summary", {}, t("advanced")), this.deep_facts,
      h("dl", { class: "facts" }, h("div", {}, h("dt", {}, t("last-command")), this.proof)),
      this.monitor = h("details", { class: "monitor", hidden: true, ontoggle: () => this.show_monitor() }, h("summary", {}, t("serial-monitor"))));
    this.listen(this, "proof", (event) => set_text(this.proof, event.proof));
    this.firmware = document.createElement("asip-firmware").begin(this.name);
    this.problem = h("p", { class: "empty", role: "status", hidden: true });
    this.warnings = h("div", { class: "warnings", role: "status" });
    this.unusable = h("p", { class: "unusable muted", role: "status" });
    this.stopped = h("p", { class: "stopped-note", role: "status" });
    this.tools = h("span", { class: "tools" });
    this.append(h("p", { class: "back" }, h("a", { href: "#/" }, `← ${t("all-boards")}`)), h("div", { class: "title-row" }, this.heading, this.mark, this.since, this.tools),
      this.problem, this.warnings, this.firmware, this.stopped, this.unusable, this.no_service, this.world_box, this.values, this.controls, this.pins_box,
      this.folding(t("links"), document.createElement("asip-links").begin(this.name)), this.folding(t("about"), this.facts, this.names, this.advanced),
      h("details", { class: "history", ontoggle: (event) => { if (!this.past) event.target.append((this.past = document.createElement("asip-history").begin(path_of("boards", this.name, "history"), false, () => this.board?.names?.pins))); } },
        h("summary", {}, h("h2", {}, t("history")))));
    this.listen(boards, "board", (event) => { if (event.board === this.name) this.reload(event.kind); });
    this.listen(boards, "change", () => this.show_state());
    this.listen(status, "change", () => this.show_state());
    this.every(1000, () => this.show_state());
    this.listen(document, "visibilitychange", () => (document.hidden ? this.unfollow() : this.follow()));
    this.while_shown(() => this.unfollow());
    this.load();
    this.follow();
  }

  /// A section that is folded where the board drives: a robot builder needs it last.
  folding(title, ...content) {
    return h("section", { "aria-label": title }, h("details", { class: "folding", open: true }, h("summary", {}, h("h2", {}, title)), content));
  }

  /// Its properties, listed by the gateway, and how they stand, as long as this page is seen.
  follow() {
    if (this.end_standing || !this.isConnected || document.hidden) return;
    this.end_standing = bus.subscribe({ subscribe: `${this.name}/$values`, max_hz: rate }, (message) => {
      for (const [id, each] of Object.entries(message.values ?? {})) this.stands.set(id, each);
      if (message.values) this.show_standing(new Map(Object.entries(message.values)));
    });
  }

  unfollow() {
    this.end_standing?.();
    this.end_standing = undefined;
  }

  async load_properties() {
    this.properties = await properties_of(this.name).catch(() => this.properties ?? []);
    if (this.isConnected) this.show_standing();
  }

  show_standing(changed = this.stands) {
    if (!this.properties) return;
    this.pins.stands(this.properties, this.stands);
    for (const element of this.shown_services.values()) element.stands(this.properties, this.stands, changed);
  }

  rate_box() {
    const id = fresh_id("rate");
    const select = h("select", { id, onchange: () => {
      rate = Number(select.value);
      for (const element of this.shown_services.values()) element.at_rate(rate);
      this.unfollow();
      this.follow();
    } }, rates.map((each) => h("option", { value: each }, t("each-second", { each }))));
    select.value = rate;
    return (this.rate = h("div", { class: "rate", hidden: true, title: t("while-page") },
      h("label", { for: id }, t("live"), " "), select));
  }

  reload(kind) {
    if (kind === "state" || kind === "forgotten") this.show_state();
    this.timer ??= setTimeout(() => { // not begun anew: a board that changes all the time is shown, too
      this.timer = undefined;
      if (this.isConnected) this.load();
    }, kReloadMs);
  }

  async load() {
    await this.load_properties();
    const drives = moves(this.properties ?? []);
    this.classList.toggle("drives", drives);
    if (drives && this.shown_services.size === 0) {
      this.values.before(this.controls); // a form that is moved later would be built twice
      for (const each of this.querySelectorAll(".folding")) each.open = false;
    }
    try {
      this.board = await request(path_of("boards", this.name));
      this.problem.hidden = true;
      if (this.isConnected) this.show();
    } catch (problem) {
      this.problem.hidden = false;
      set_text(this.problem, problem.status === 404 ? t("there-no-board", { name: this.name }) : problem.message);
    }
    this.show_state();
  }

  show_state() {
    const row = boards.catalogue.rows.get(this.name);
    const state = row?.state ?? (this.board && shown_state(this.board));
    if (state !== this.state) {
      this.state = state;
      this.mark.replaceChildren(state ? state_mark(state) : "");
      this.show_tools();
    }
    const since = row?.since ?? time_of(this.board?.since);
    const time = since === undefined ? "" : `${t("since-since", { since: moment_text(since) })} (${duration_text(Date.now() - since)})`;
    set_text(this.since, [time, reason_text(row?.reason ?? this.board?.reason)].filter(Boolean).join(": "));
    this.classList.toggle("gone", Boolean(state) && !alive(state));
    this.show_usable(state);
    const stop = row?.reason === "latched" || this.board?.reason === "latched" ? this.board?.description?.stopped : undefined;
    set_text(this.stopped, row?.reason === "latched" && alive(state) ? `${stop?.by ? t("stopped-who", { who: who_text(stop.by) }) : t("stopped")}${stop?.why ? `: ${stop.why}` : ""}. ${t("commands-refused")}` : "");
    if (this.tools_for !== rights()) this.show_tools();
  }

  /// Commands cannot reach a board that is not there, whose port is lent, or that is behind a lost broker: then its forms are off.
  show_usable(state) {
    const reachable = bus.link.state === "open" && status.now?.broker?.connected !== false;
    const usable = reachable && (state === undefined || (alive(state) && state !== "updating"));
    const now = { state: state ?? "online", reason: boards.catalogue.rows.get(this.name)?.reason };
    for (const element of this.shown_services.values()) element.usable = usable;
    for (const element of [...this.shown_services.values(), this.pins]) element.board_is(now);
    if (this.pins.panel) this.pins.panel.inert = !usable;
    set_text(this.unusable, usable ? "" : !reachable ? t("commands-off") : state === "updating" ? t("commands-off-port") : t("commands-off-until"));
  }

  /// As long as it is open the board's agent tells what goes over the line.
  async show_monitor() {
    this.line?.remove();
    this.line = undefined;
    if (!this.monitor.open) return;
    await import("./monitor.js");
    if (this.monitor.open && !this.line) this.monitor.append(this.line = document.createElement("asip-monitor").begin(this.name));
  }

  show_tools() {
    this.tools_for = rights();
    this.monitor.hidden = !status.may_command;
    const stop = () => status.may_stop && h("asip-stop", { board: this.name });
    const forget = () => status.may_forget && h("button", { onclick: () => this.ask_to_forget() }, t("forget-board"));
    const tool = this.state && (alive(this.state) ? stop() : forget());
    this.tools.replaceChildren(...(tool ? [tool] : []));
  }

  /// Everything that is kept of it on the bus is cleared: one wrong click does not do that.
  ask_to_forget() {
    const no = h("button", { onclick: () => this.show_tools() }, t("keep"));
    this.tools.replaceChildren(h("span", {}, t("forget-name", { name: this.name })), " ",
      h("button", { class: "danger", onclick: () => this.forget() }, t("yes-forget")), " ", no);
    no.focus();
  }

  async forget() {
    try {
      await request(path_of("boards", this.name), { method: "DELETE", body: {} });
      location.hash = "#/";
    } catch (problem) {
      this.problem.hidden = false;
      set_text(this.problem, problem.message);
    }
  }

  show() {
    const { board } = this;
    const description = board.description ?? { services: board.services };
    const called = board.labels?.name;
    set_text(this.heading.firstChild, called || this.name);
    this.warnings.replaceChildren(...(description.warnings ?? []).map((text) => h("p", {}, text)));
    set_text(this.heading.lastChild, called ? ` ${this.name}` : "");
    this.facts.replaceChildren(...facts_of([[t("chip"), board.chip], [t("sketch"), firmware_text(board)],
      [t("labels"), label_texts(board.labels).join(", ")],
      [t("conflict"), board.conflict && t("another-agent", { other: board.conflict.other_agent ?? board.conflict.other })],
      [t("known"), !board.description && t("names-only")]]));
    this.deep_facts.replaceChildren(...facts_of([[t("protocol"), board.protocol && `ASIP ${board.protocol}`], [t("link"), board.link], [t("agent"), board.agent]]));
    this.names.show(board);
    this.firmware.show(board);
    this.rate.hidden = !description.on_demand;
    this.show_pins(description);
    this.show_services((description.services ?? board.services ?? []).map((service) => (
      { ...service, label: board.names?.services?.[service.name] })));
  }

  show_pins(description) {
    const key = JSON.stringify([description.pins, description.services, description.names]);
    if (key === this.pins_key) return;
    this.pins_key = key;
    this.pins_box.hidden = !has_pins(description);
    this.pins.begin(this.name, description);
    if (!this.pins_box.hidden && !this.pins.isConnected) this.pins_box.append(this.pins);
  }

  show_world(floor, rovers) {
    this.world_box.hidden = !floor;
    if (floor && this.world?.service !== floor.name) {
      this.world?.remove();
      this.world = document.createElement("asip-world").begin(this.name, floor.name);
      this.world_box.append(this.world);
    }
    this.world?.keep(rovers.map((each) => each.name));
  }

  // Services that stay keep their element: what is entered in a form must not vanish when the board says something new.
  show_services(services) {
    const pins = !this.pins_box.hidden;
    const floor = services.find(is_floor);
    this.show_world(floor, services.filter(is_pose));
    const order = services.filter((service) => service !== floor).sort((a, b) => !a.label - !b.label || (a.name === "io") - (b.name === "io"));
    const focused = this.classList.contains("drives") || Boolean(order[0]?.label); // what is not in use is folded
    const known = this.shown_services;
    this.shown_services = new Map(order.map((service) => {
      const key = JSON.stringify([service.name, service.model, pins, Boolean(this.board.description?.on_demand)]);
      const element = known.get(key) ?? document.createElement("asip-service").begin(this.name, service, {
        controls: this.controls, advanced: this.advanced, hz: rate, on_demand: Boolean(this.board.description?.on_demand),
        folded: focused && !service.label, pins: pins && service.name === "io", on_value: is_pose(service) ? (value) => this.world?.moved(service.name, value) : undefined });
      if (known.has(key)) element.update(service);
      return [key, element];
    }));
    for (const [key, element] of known) if (!this.shown_services.has(key)) element.remove();
    for (const element of this.shown_services.values()) if (!element.isConnected) this.values.append(element);
    this.show_standing();
    this.no_service.hidden = services.length > 0;
  }
}

customElements.define("asip-board", Board);
