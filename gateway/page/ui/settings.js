// SPDX-License-Identifier: Apache-2.0
// Settings and health: other systems, who may do what, notices, programs with their versions and counters, and boards that are not there.
import { alive } from "../core/catalogue.js";
import { count_text, t } from "../core/language.js";
import { counter_text, duration_text, moment_text, role_text, state_text, time_of, who_text } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { command_line, h, muted, page_of, Part, set_class, set_text, state_mark } from "./dom.js";
import { boards, status } from "./model.js";
import "./access.js";
import "./exports.js";
import "./notify.js";

const kMaxLost = 200;
const kMaxHosts = 20;

class Settings extends Part {
  shown() {
    this.cards = new Map();
    this.programs = h("div", { class: "cards" });
    this.hosts = h("div", {});
    this.lost_body = h("tbody", {});
    this.lost_note = h("p", { class: "muted", role: "status" });
    this.lost_table = h("div", { class: "wide", tabindex: "0", role: "region", "aria-label": t("which-since") },
      h("table", {}, h("thead", {}, h("tr", {}, [t("board"), t("state"), t("since"), t("for")].map((head) => h("th", { scope: "col" }, head)))), this.lost_body));
    this.append(h("h1", { tabindex: "-1" }, t("settings-health")),
      section(t("boards-not"), this.lost_note, this.lost_table),
      section(t("other-systems"), document.createElement("asip-exports")),
      section(t("users-links"), document.createElement("asip-access")),
      section(t("notices"), document.createElement("asip-notify").begin(true),
        muted(t("registry-tells")),
        command_line("echo ASIP_NOTIFY=ADDRESS | sudo tee -a /etc/asip/registry.env && sudo systemctl restart asip-registry")),
      section(t("programs"), this.programs,
        h("details", { ontoggle: (event) => { if (event.target.open) this.load_hosts(); } }, h("summary", {}, t("agents-their")), this.hosts),
        h("details", {}, h("summary", {}, t("their-logs")), muted(t("what-boards")), command_line("asipctl events --logs"),
          muted(t("what-programs")), command_line("journalctl -u 'asip-*' -n 100"))));
    this.listen(status, "change", () => this.show_cards());
    this.listen(boards, "change", () => this.show_lost());
    this.every(2000, () => status.refresh());
    this.every(5000, () => this.show_lost());
    status.refresh();
    this.show_cards();
    this.show_lost();
  }

  show_cards() {
    const now = status.now;
    if (!now) return;
    const { broker = {}, mirror = {}, streams = {}, registries = [], you = {} } = now; // of a limited token without what is not of its boards
    const shown = new Set([t("broker"), t("gateway"), t("you"), ...registries.map((each) => t("registry-id", { id: each.id }))]);
    this.card(t("broker"), broker.connected === false ? ["lost", t("not-connected")] : ["online", t("connected")], [[t("address"), broker.address], [t("since"), since_text(broker.since)]]);
    this.card(t("gateway"), mirror.complete === false ? ["updating", t("collecting")] : ["online", t("up-date")], [[t("version"), now.version], [t("boards"), mirror.boards ?? boards.catalogue.rows.size]],
      [[t("open-streams"), streams.clients], [t("values-left-out"), streams.left_out]]);
    for (const { id, state, since, stats = {} } of registries) {
      const { version, uptime, services, ...counters } = stats;
      this.card(t("registry-id", { id }), [state, state_text(state)], [[t("version"), version], [t("runs"), uptime === undefined ? undefined : duration_text(uptime * 1000)], [t("since"), since_text(since)]], counters_of(counters));
    }
    if (registries.length === 0 && !you.limited) {
      shown.add(t("registries"));
      this.card(t("registries"), ["offline", t("none")], [[t("missing"), t("history-search")]]);
    }
    this.card(t("you"), you.session && ["online", t("signed")], [[t("name-within"), who_text(you.name ?? "")], [t("role"), role_text(you.role)]]);
    const you_box = this.cards.get(t("you")).box;
    if (you.session && !you_box.querySelector("button")) you_box.append(h("button", { onclick: sign_out }, t("sign-out")));
    for (const [title, { box }] of this.cards) if (!shown.has(title)) { box.remove(); this.cards.delete(title); }
  }

  /// Built once; what is read, unfolded or focused in it stays where it is.
  card(title, state, facts, counters = []) {
    let card = this.cards.get(title);
    if (!card) {
      card = { mark: h("span", {}), facts: h("dl", { class: "facts" }), counters: h("dl", { class: "facts" }) };
      card.more = h("details", {}, h("summary", {}, t("counters")), card.counters);
      card.box = h("article", { class: "card" }, h("h2", {}, title, " ", card.mark), card.facts, card.more);
      this.cards.set(title, card);
      this.programs.append(card.box);
    }
    set_class(card.mark, state ? `state ${state[0]}` : "");
    set_text(card.mark, state ? state[1] : "");
    fill(card.facts, facts);
    card.more.hidden = fill(card.counters, counters) === 0;
  }

  /// A version is in the description of a board: one of each machine is asked.
  async load_hosts() {
    this.hosts.replaceChildren(muted(t("looking-what")));
    const hosts = new Map();
    const { items, total } = await request("api/boards?limit=1000").catch(() => ({ items: [] }));
    for (const { agent, board } of items) if (agent) hosts.set(agent.split(" ")[0], [...hosts.get(agent.split(" ")[0]) ?? [], board]);
    const asked = [...hosts].slice(0, kMaxHosts);
    const versions = await Promise.all(asked.map(([, names]) => request(path_of("boards", names[0])).then((board) => board.description?.agent?.version, () => undefined)));
    const list = h("dl", { class: "facts" });
    fill(list, asked.map(([host, names], i) => [`${host}, ${t("n-boards", { n: names.length })}`, versions[i] ?? t("not-known")]));
    const more = hosts.size > kMaxHosts || total > items.length;
    this.hosts.replaceChildren(hosts.size > 0 ? list : muted(t("no-board-agent")), more ? muted(t("there-more")) : "");
  }

  show_lost() {
    const gone = boards.catalogue.view({ sort: "since" }).filter((row) => !alive(row.state));
    const now = Date.now();
    set_text(this.lost_note, boards.catalogue.rows.size === 0 ? t("lesson-no-board") : gone.length === 0 ? t("every-board") : gone.length > kMaxLost ? t("latest-most", { most: kMaxLost, gone: gone.length }) : "");
    this.lost_table.hidden = gone.length === 0;
    this.lost_body.replaceChildren(...gone.slice(0, kMaxLost).map((row) => h("tr", {},
      h("td", {}, h("a", { href: page_of("board", row.name) }, row.called || row.name)), h("td", {}, state_mark(row.state)),
      h("td", {}, moment_text(row.since, now)), h("td", {}, row.since === undefined ? "" : duration_text(now - row.since)))));
  }
}

const section = (title, ...parts) => h("section", { "aria-label": title }, h("h2", {}, title), parts);

async function sign_out() {
  await request("api/session", { method: "DELETE" }).catch(() => undefined);
  location.reload();
}

function since_text(value) {
  const ms = time_of(value);
  return ms === undefined ? undefined : `${moment_text(ms)} (${duration_text(Date.now() - ms)})`;
}

/// The facts that are known; how many they are.
function fill(list, facts) {
  const known = facts.filter(([, value]) => value !== undefined && value !== "");
  if (JSON.stringify(known) !== list.told) list.replaceChildren(...known.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, String(value)))));
  list.told = JSON.stringify(known);
  return known.length;
}

// Counters as they are: {"boards":{"online":2},"messages":10} to [["Boards online", 2], ["Messages", 10]].
function counters_of(object, prefix = "") {
  return Object.entries(object ?? {}).flatMap(([name, value]) => {
    if (value !== null && typeof value === "object") return counters_of(value, `${prefix}${name} `);
    return typeof value === "number" && value !== 0 && name !== "seq" ? [[counter_text(prefix + name), count_text(value)]] : [];
  });
}

customElements.define("asip-settings", Settings);
