// SPDX-License-Identifier: Apache-2.0
// What several screens share: the catalogue and the state of gateway and broker.
import { Catalogue } from "../core/catalogue.js";
import { bus, request } from "../net/bus.js";

const kRefreshMs = 150;

class BoardList extends EventTarget {
  constructor() {
    super();
    this.catalogue = new Catalogue();
    this.end = bus.subscribe({ subscribe: "$catalogue" }, (message) => this.received(message));
  }

  received(message) {
    if (message.event === undefined) return;
    if (message.event === "dashboards") return void this.dispatchEvent(new Event("dashboards"));
    this.catalogue.apply(message);
    if (message.event === "status") status.refresh();
    if (message.event === "snapshot-end") this.changed();
    else this.timer ??= setTimeout(() => this.changed(), kRefreshMs);
    const board = message.board?.board ?? message.board;
    if (board) this.dispatchEvent(Object.assign(new Event("board"), { board, kind: message.event }));
  }

  /// The link of a dashboard shows no catalogue.
  leave() {
    this.end?.();
    this.end = undefined;
  }

  changed() {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.dispatchEvent(new Event("change"));
  }
}

class Status extends EventTarget {
  constructor() {
    super();
    this.now = undefined;   // what GET /api/status said last
    this.problem = undefined;
    this.asking = false;
    bus.addEventListener("link", () => this.refresh());
    setInterval(() => { if (!document.hidden) this.refresh(); }, 10_000);
  }

  async refresh() {
    if (this.asking) return;
    this.asking = true;
    try {
      this.now = await request("api/status");
      this.problem = undefined;
    } catch (problem) {
      this.problem = problem;
      if (this.refused) this.now = undefined; // what it allowed is over
    }
    this.asking = false;
    if (this.you.dashboard) boards.leave();
    this.dispatchEvent(new Event("change"));
  }

  /// The gateway answers, and shows this browser nothing: a token is needed (401), or the link is not valid any more (404).
  get refused() { return this.problem?.status === 401 || this.problem?.status === 404; }
  get you() { return this.now?.you ?? {}; }
  /// Only what the gateway says: before that, nothing. What its viewer may not do is not shown.
  get may_command() { return this.you.command === true; }
  get may_label() { return this.you.label === true; }
  /// A stop reaches every service of a board: it is not for users who see some services only.
  get may_stop() { return this.you.stop === true; }
  get may_forget() { return this.you.forget === true; }
}

export const status = new Status();
export const boards = new BoardList();
