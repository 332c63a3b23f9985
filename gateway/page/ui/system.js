// SPDX-License-Identifier: Apache-2.0
// The bus itself: broker, gateway, registries, and what was lost since when.
import { alive } from "../core/catalogue.js";
import { duration_text, moment_text, time_of, words } from "../core/text.js";
import { request } from "../net/bus.js";
import { h, Part, set_text, state_mark } from "./dom.js";
import { boards, status } from "./model.js";

const kMaxLost = 200;

class System extends Part {
  shown() {
    this.cards = h("div", { class: "cards" });
    this.lost_body = h("tbody", {});
    this.lost_note = h("p", { class: "muted", role: "status" });
    this.lost_table = h("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Boards that are not there" },
      h("table", {}, h("thead", {}, h("tr", {}, ["Board", "State", "Since", "For"].map((head) => h("th", { scope: "col" }, head)))), this.lost_body));
    this.append(h("h1", { tabindex: "-1" }, "Bus"), this.cards, h("section", {}, h("h2", {}, "Boards that are not there"), this.lost_note, this.lost_table));
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
    const { broker = {}, mirror = {}, streams = {}, registries = [] } = now; // of a limited token without what is not of its boards
    const cards = [
      card("Broker", broker.connected === false ? ["lost", "not connected"] : ["online", "connected"], [["Address", broker.address], ["Since", since_text(broker.since)]]),
      card("Gateway", mirror.complete === false ? ["updating", "collecting"] : ["online", "up to date"],
        [["Version", now.version], ["Learns from", mirror.registry ? `registry ${mirror.registry}` : mirror.source], ["Boards", mirror.boards ?? boards.catalogue.rows.size],
          ["You are", [now.you?.name, now.you?.role].filter(Boolean).join(", ")], ["Open streams", streams.clients], ["Values left out", streams.left_out]]),
      ...(now.you?.session ? [h("article", { class: "card" }, h("h2", {}, "This browser"), h("button", { onclick: sign_out }, "Sign out"))] : []),
      ...registries.map((each) => card(`Registry ${each.id}`, [each.state, each.state], [["Since", since_text(each.since)], ...facts_of(each.stats)])),
    ];
    if (registries.length === 0 && !now.you?.limited) cards.push(h("article", { class: "card" }, h("h2", {}, "Registries"), h("p", { class: "muted" }, "None is there. Boards work without one; history needs one.")));
    // Replaced only where something changed: a user who reads it keeps the place.
    const texts = cards.map((each) => each.textContent).join("|");
    if (texts === this.texts) return;
    this.texts = texts;
    this.cards.replaceChildren(...cards);
  }

  show_lost() {
    const gone = boards.catalogue.view({ sort: "since" }).filter((row) => !alive(row.state));
    const now = Date.now();
    set_text(this.lost_note, gone.length === 0 ? "Every board that is known is there." : gone.length > kMaxLost ? `The latest ${kMaxLost} of ${gone.length}:` : "");
    this.lost_table.hidden = gone.length === 0;
    this.lost_body.replaceChildren(...gone.slice(0, kMaxLost).map((row) => h("tr", {},
      h("td", {}, h("a", { href: `#/board/${encodeURIComponent(row.name)}` }, row.name)), h("td", {}, state_mark(row.state)),
      h("td", {}, moment_text(row.since, now)), h("td", {}, row.since === undefined ? "" : duration_text(now - row.since)))));
  }
}

async function sign_out() {
  await request("api/session", { method: "DELETE" }).catch(() => undefined);
  location.reload();
}

function since_text(value) {
  const ms = time_of(value);
  return ms === undefined ? undefined : `${moment_text(ms)} (${duration_text(Date.now() - ms)})`;
}

// Counters as they are: {"boards":{"online":2},"messages":10} to [["Boards online", 2], ["Messages", 10]].
function facts_of(object, prefix = "") {
  return Object.entries(object ?? {}).flatMap(([name, value]) => {
    if (value !== null && typeof value === "object") return facts_of(value, `${prefix}${name} `);
    if (name === "uptime") return [["Runs for", duration_text(value * 1000)]];
    return typeof value === "number" && value !== 0 && name !== "seq" ? [[words(prefix + name), value.toLocaleString("en", { maximumFractionDigits: 1 })]] : [];
  });
}

function card(title, [state, text], facts) {
  return h("article", { class: "card" }, h("h2", {}, title, " ", h("span", { class: `state ${state}` }, text)),
    h("dl", { class: "facts" }, facts.filter(([, value]) => value !== undefined && value !== "").map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, String(value))))));
}

customElements.define("asip-system", System);
