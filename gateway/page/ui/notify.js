// SPDX-License-Identifier: Apache-2.0
// Notifications of the browser for boards that are lost. Nothing is asked before the user presses the button.
import { Losses } from "../core/attention.js";
import { t } from "../core/language.js";
import { script_url } from "../net/bus.js";
import { h, Part, set_text } from "./dom.js";
import { boards, status } from "./model.js";

const kKept = "asip-notify";
const losses = new Losses();

function wanted() {
  try {
    return localStorage.getItem(kKept) === "yes" && Notification.permission === "granted";
  } catch {
    return false; // nothing may be kept here, or this browser has no notifications
  }
}

function keep(on) {
  try {
    localStorage.setItem(kKept, on ? "yes" : "no");
  } catch { /* it holds as long as nothing is kept: not at all */ }
}

boards.addEventListener("change", () => {
  if (!boards.catalogue.complete) return;
  const text = losses.of(boards.catalogue.rows.values(), Date.now());
  if (!text || !wanted()) return;
  // One notice stays of several tabs, and of a loss that grows: that is what its tag is for.
  tell(text);
});

const tell = ({ title, body }) => worker().then((it) => it.showNotification(title, { body, tag: "asip-lost", icon: "icon.svg" }));

async function worker() {
  await navigator.serviceWorker.register(script_url("notices.js"));
  return navigator.serviceWorker.ready;
}
navigator.serviceWorker?.addEventListener("message", () => { location.hash = "#/?state=lost"; });

class Notify extends Part {
  /// Call before it is put into the page. `whole`: with a notice to try.
  begin(whole) {
    this.whole = whole;
    return this;
  }

  shown() {
    this.button = h("button", { onclick: () => this.turn() }, t("notify-me"));
    this.answer = h("span", { role: "status", class: "muted" });
    this.trial = h("button", { onclick: () => tell({ title: t("board-lost"), body: t("so-told") }) }, t("try"));
    this.append(this.button, " ", this.trial, " ", this.answer);
    this.listen(status, "change", () => this.show());
    this.show();
  }

  show() {
    this.hidden = !("Notification" in window && navigator.serviceWorker) || !status.now || status.you.role === "kiosk";
    this.button.setAttribute("aria-pressed", String(wanted()));
    this.trial.hidden = !this.whole || !wanted();
  }

  async turn() {
    const on = !wanted();
    const allowed = on ? await Notification.requestPermission() === "granted" : true;
    keep(on && allowed);
    set_text(this.answer, allowed ? "" : t("browser-does"));
    this.show();
  }
}

customElements.define("asip-notify", Notify);
