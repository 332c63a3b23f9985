// SPDX-License-Identifier: Apache-2.0
// Other systems that boards are shown to. The gateway's own user may write no file of the machine and start nothing anew: to switch
// one on or off is a command that a person types there.
import { t } from "../core/language.js";
import { command_line, h, muted, Part, set_class, set_text } from "./dom.js";
import { status } from "./model.js";

const names = { sparkplug: "plant" }; // what the command needs beside the system

function words_of({ on, shows, other }) {
  if (shows) return ["online", t("shows-your")];
  if (on) return other ? ["online", t("gateway-other", { other })] : ["updating", t("begins")];
  return ["offline", other ? t("off-here", { other }) : t("off")];
}

function found_text({ system, found }) {
  if (system !== "home-assistant") return "";
  if (found === undefined) return t("said-nothing");
  return found ? t("found-uses") : t("was-broker");
}

class Exports extends Part {
  shown() {
    this.cards = new Map();
    this.note = muted();
    this.box = h("div", { class: "cards" });
    this.append(this.note, this.box);
    this.listen(status, "change", () => this.show());
    this.show();
  }

  show() {
    const { exports = [] } = status.now ?? {};
    set_text(this.note, exports.length > 0 ? "" : t("your-token-shows"));
    for (const each of exports) {
      let card = this.cards.get(each.system);
      if (!card) {
        card = { mark: h("span", {}), found: muted(), how: h("details", {}) };
        this.cards.set(each.system, card);
        this.box.append(h("article", { class: "card" }, h("h3", {}, each.title), card.mark, card.found, card.how));
      }
      const [state, text] = words_of(each);
      set_class(card.mark, `state ${state}`);
      set_text(card.mark, text);
      set_text(card.found, found_text(each));
      card.how.hidden = status.you.role !== "admin";
      if (card.on === each.on) continue;
      card.on = each.on;
      card.how.replaceChildren(h("summary", {}, each.on ? t("switch-off") : t("switch")), muted(t("gateways-machine")),
        command_line(["sudo asip-gateway export", each.system, each.on ? "--off" : names[each.system] ?? ""].join(" ").trim()));
    }
  }
}

customElements.define("asip-exports", Exports);
