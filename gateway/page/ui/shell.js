// SPDX-License-Identifier: Apache-2.0
// What stands above every screen: the state of the connection, what is wrong, and the stop button.
import { t } from "../core/language.js";
import { clock_text, duration_text } from "../core/text.js";
import { bus, path_of, request } from "../net/bus.js";
import { h, Part, set_class, set_text } from "./dom.js";
import { attention_of } from "../core/attention.js";
import { boards, status } from "./model.js";

const kShownAfterMs = 700;
const kFirstMs = 3000; // a page that has just begun is no loss

class LinkSign extends Part {
  shown() {
    this.sign = h("span", { role: "status" });
    this.append(this.sign);
    this.listen(bus, "link", () => this.show());
    this.listen(status, "change", () => this.show());
    this.show();
  }

  show() {
    const broker = status.now?.broker?.connected !== false;
    const { state, was_open } = bus.link;
    const apart = was_open ? ["bad", t("not-connected")] : ["warn", t("connecting")];
    const [kind, text] = state !== "open" ? apart : broker ? ["good", t("live-within")] : ["warn", t("no-broker")];
    this.hidden = status.refused; // then there is nothing to be connected to
    set_class(this.sign, `sign ${kind}`);
    set_text(this.sign, text);
  }
}

class Banner extends Part {
  shown() {
    this.setAttribute("role", "alert");
    this.listen(bus, "link", () => this.show());
    this.listen(status, "change", () => this.show());
    this.every(500, () => this.show());
  }

  show() {
    const text = this.text();
    set_text(this, text);
    this.hidden = text === "";
    document.body.classList.toggle("stale", bus.link.state !== "open" && text !== "");
  }

  text() {
    const { state, since, was_open } = bus.link;
    if (state !== "open" && Date.now() - since > (was_open ? kShownAfterMs : kFirstMs)) {
      if (status.refused) return "";
      if (!was_open) return t("gateway-does-not-answer");
      return t("connection-gateway", { since: clock_text(since) });
    }
    const { broker, mirror } = status.now ?? {};
    if (broker?.connected === false) {
      const from = broker.since ? ` (${t("since-since", { since: clock_text(Date.parse(broker.since)) })})` : "";
      return t("gateway-no", { from });
    }
    return mirror?.complete === false ? t("gateway-still") : "";
  }
}

/// Stops everything, or the board in its attribute `board`, until a user resumes it. Nothing is shown to a viewer that may not stop.
class Stop extends Part {
  shown() {
    const board = this.getAttribute("board");
    this.path = board ? path_of("boards", board) : "api";
    this.button = h("button", { class: "stop", hidden: true, title: t("brings-every"),
      onclick: () => this.stop() });
    this.answer = h("span", { role: "status", class: "stop-answer" });
    this.resume_button = h("button", { class: "resume", hidden: true, title: t("nothing-moves"), onclick: () => this.resume() });
    this.append(this.button, this.resume_button, this.answer);
    const allow = () => {
      this.button.hidden = !status.may_stop;
      const stopped = board ? boards.catalogue.rows.get(board)?.reason === "latched" : attention_of(boards.catalogue.rows.values()).stopped.length > 0;
      this.resume_button.hidden = status.you.resume !== true || !stopped;
      set_text(this.resume_button, board ? t("resume-board", { board }) : t("resume-all"));
      set_text(this.button, board ? t("stop-board", { board }) : status.you.limited ? t("stop-my-boards") : t("stop-all"));
    };
    this.listen(status, "change", allow);
    this.listen(boards, "change", allow);
    allow();
  }

  async stop() {
    const began = performance.now();
    set_text(this.answer, t("stopping"));
    try {
      const answer = await request(`${this.path}/stop`, { method: "POST", body: {} });
      set_text(this.answer, stop_text(answer, performance.now() - began));
    } catch (problem) {
      set_text(this.answer, t("not-stopped-message", { message: problem.message }));
      this.answer.classList.add("bad");
      return;
    }
    this.said();
  }

  async resume() {
    try {
      const failed = unproven(await request(`${this.path}/resume`, { method: "POST", body: {} }));
      set_text(this.answer, failed.length > 0 ? t("not-resumed-message", { message: some(failed) }) : t("resumed"));
    } catch (problem) {
      set_text(this.answer, t("not-resumed-message", { message: problem.message }));
      this.answer.classList.add("bad");
      return;
    }
    this.said();
  }

  said() {
    this.answer.classList.remove("bad");
    clearTimeout(this.timer);
    this.timer = setTimeout(() => set_text(this.answer, ""), 6000);
  }
}

const unproven = (answer) => Object.entries(answer?.boards ?? {}).filter(([, each]) => each.status !== "ok").map(([board]) => board);
const some = (names) => `${names.slice(0, 3).join(", ")}${names.length > 3 ? " …" : ""}`;

function stop_text(answer, ms) {
  const failed = unproven(answer);
  if (failed.length > 0) return t("stopped-but", { failed: some(failed) });
  const time = ms < 500 ? `${Math.round(ms)} ms` : duration_text(ms);
  return status.you.resume ? t("stopped-time", { time }) : t("stopped-once", { time });
}

customElements.define("asip-link", LinkSign);
customElements.define("asip-banner", Banner);
customElements.define("asip-stop", Stop);
