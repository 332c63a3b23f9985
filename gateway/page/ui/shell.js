// SPDX-License-Identifier: Apache-2.0
// What stands above every screen: the state of the connection, what is wrong, and the stop button.
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
    const apart = was_open ? ["bad", "not connected"] : ["warn", "connecting"];
    const [kind, text] = state !== "open" ? apart : broker ? ["good", "live"] : ["warn", "no broker"];
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
      if (!was_open) return "The gateway does not answer. Trying again …";
      return `The connection to the gateway is lost since ${clock_text(since)}. What you see may be old. Trying again …`;
    }
    const { broker, mirror } = status.now ?? {};
    if (broker?.connected === false) {
      const from = broker.since ? ` since ${clock_text(Date.parse(broker.since))}` : "";
      return `The gateway has no connection to the broker. Boards cannot be reached, and their states are not known${from}.`;
    }
    return mirror?.complete === false ? "The gateway is still collecting which boards are there." : "";
  }
}

/// Stops everything, or the board in its attribute `board`, until a user resumes it. Nothing is shown to a viewer that may not stop.
class Stop extends Part {
  shown() {
    const board = this.getAttribute("board");
    this.path = board ? path_of("boards", board) : "api";
    this.button = h("button", { class: "stop", hidden: true, title: "Brings every motor, light and output into its safe state, ahead of all commands",
      onclick: () => this.stop() });
    this.answer = h("span", { role: "status", class: "stop-answer" });
    this.resume_button = h("button", { class: "resume", hidden: true, title: "Nothing moves by it; commands are executed again", onclick: () => this.resume() });
    this.append(this.button, this.resume_button, this.answer);
    const allow = () => {
      this.button.hidden = !status.may_stop;
      const stopped = board ? boards.catalogue.rows.get(board)?.reason === "latched" : attention_of(boards.catalogue.rows.values()).stopped.length > 0;
      this.resume_button.hidden = !status.may_stop || !stopped;
      set_text(this.resume_button, board ? `Resume ${board}` : "Resume all");
      set_text(this.button, board ? `Stop ${board}` : status.you.limited ? "Stop my boards" : "Stop all");
    };
    this.listen(status, "change", allow);
    this.listen(boards, "change", allow);
    allow();
  }

  async stop() {
    const began = performance.now();
    set_text(this.answer, "Stopping …");
    try {
      const answer = await request(`${this.path}/stop`, { method: "POST", body: {} });
      set_text(this.answer, stop_text(answer, performance.now() - began));
    } catch (problem) {
      set_text(this.answer, `Not stopped: ${problem.message}`);
      this.answer.classList.add("bad");
      return;
    }
    this.said();
  }

  async resume() {
    try {
      const failed = unproven(await request(`${this.path}/resume`, { method: "POST", body: {} }));
      set_text(this.answer, failed.length > 0 ? `Not resumed: ${some(failed)}` : "Resumed");
    } catch (problem) {
      set_text(this.answer, `Not resumed: ${problem.message}`);
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
  if (failed.length > 0) return `Stopped, but no proof from ${some(failed)}`;
  return `Stopped in ${duration_text(ms) === "0 s" ? `${Math.round(ms)} ms` : duration_text(ms)}; commands are refused until it is resumed`;
}

customElements.define("asip-link", LinkSign);
customElements.define("asip-banner", Banner);
customElements.define("asip-stop", Stop);
