// SPDX-License-Identifier: Apache-2.0
// One connection to the gateway for all tabs of the browser. Each tab is a port; what it subscribed to and what it asked
// belongs to it alone, and goes when it goes.
import { Link } from "../core/link.js";

const kTabSilentMs = 200_000; // browsers let the timers of hidden tabs run once a minute
const kBatchMs = 8;

export class Hub {
  /// `api`: address of the gateway's API, with a slash at its end.
  constructor(api) {
    this.api = api;
    this.session = crypto.getRandomValues(new Uint32Array(3)).join("-"); // outlives a connection: so the outcome of a command is found
    this.link = new Link();
    this.socket = undefined;
    this.tabs = new Map(); // number -> {port, heard_at, batch, timer}
    this.last_tab = 0;
    this.state = { state: "idle", since: Date.now(), was_open: false };
    setInterval(() => this.tick(), 1000);
    self.addEventListener("online", () => this.run((now) => this.link.hurry(now)));
  }

  run(input) {
    input(performance.now());
    for (const action of this.link.take_actions()) this.perform(action);
  }

  perform(action) {
    if (action.open) this.open();
    else if (action.close) this.close();
    else if (action.send) this.socket?.send(JSON.stringify(action.send));
    else if (action.fetch) this.fetch(action.fetch);
    else if (action.deliver) this.deliver(action.deliver);
    else if (action.state) this.set_state(action.state);
  }

  open() {
    const url = new URL(`stream?session=${this.session}`, this.api);
    url.protocol = url.protocol.replace("http", "ws");
    const socket = new WebSocket(url);
    this.socket = socket;
    const mine = (input) => { if (this.socket === socket) this.run(input); };
    socket.onopen = () => mine((now) => this.link.opened(now));
    socket.onmessage = (event) => mine((now) => this.link.received(JSON.parse(event.data), now));
    socket.onclose = () => mine((now) => this.link.closed(now));
  }

  async fetch(id) {
    const asked = fetch(new URL(`commands/${encodeURIComponent(id)}`, this.api), { headers: { "Asip-Session": this.session }, signal: AbortSignal.timeout(5000) });
    const record = await asked.then((response) => (response.status === 404 ? null : response.ok ? response.json() : undefined)).catch(() => undefined);
    this.run((now) => this.link.fetched(id, record, now));
  }

  close() {
    const { socket } = this;
    this.socket = undefined;
    socket?.close();
  }

  set_state(state) {
    // "connecting" after "waiting" is still the same loss: since when it lasts must not begin anew.
    const lost = (each) => each === "waiting" || each === "connecting";
    const since = lost(state) && lost(this.state.state) ? this.state.since : Date.now();
    this.state = { state, since, was_open: this.state.was_open || state === "open" };
    for (const number of this.tabs.keys()) this.post(number, { link: this.state });
  }

  add(port) {
    const number = ++this.last_tab;
    this.tabs.set(number, { port, heard_at: performance.now(), batch: [], timer: undefined });
    port.onmessage = (event) => this.from_tab(number, port, event.data);
    this.post(number, { link: this.state });
    this.run((now) => this.link.start(now));
  }

  from_tab(number, port, message) {
    const tab = this.tabs.get(number);
    if (!tab) return port.postMessage([{ expired: true }]); // it slept too long: it says hello again
    tab.heard_at = performance.now();
    const name = (id) => `${number}.${id}`;
    if (message.subscribe) this.run(() => this.link.subscribe(name(message.ref), message.subscribe));
    else if (message.unsubscribe) this.run(() => this.link.unsubscribe(name(message.unsubscribe)));
    else if (message.command) this.run((now) => this.link.command(name(message.id), message.command, now));
    else if (message.renew) this.run(() => this.link.renew(name(message.id), message.renew));
    else if (message.release) this.link.held.delete(name(message.release));
    else if (message.anew) this.socket?.close();
    else if (message.hurry) this.run((now) => this.link.hurry(now));
    else if (message.bye) this.remove(number);
  }

  deliver(message) {
    const key = message.ref !== undefined ? "ref" : "id";
    const [tab, rest] = String(message[key] ?? "").split(/\.(.*)/s);
    if (rest !== undefined) this.post(Number(tab), { ...message, [key]: rest });
  }

  // The first message goes at once, what follows within a few milliseconds goes together.
  post(number, message) {
    const tab = this.tabs.get(number);
    if (!tab) return;
    if (tab.timer !== undefined) return void tab.batch.push(message);
    tab.port.postMessage([message]);
    const flush = () => {
      tab.timer = undefined;
      if (tab.batch.length === 0) return;
      tab.port.postMessage(tab.batch);
      tab.batch = [];
      tab.timer = setTimeout(flush, kBatchMs);
    };
    tab.timer = setTimeout(flush, kBatchMs);
  }

  remove(number) {
    if (!this.tabs.delete(number)) return;
    const mine = [...this.link.subscriptions.keys()].filter((ref) => ref.startsWith(`${number}.`));
    for (const ref of mine) this.run(() => this.link.unsubscribe(ref));
  }

  tick() {
    const now = performance.now(); // no setting of the clock ends tabs or keeps a retry waiting
    for (const [number, tab] of this.tabs) if (now - tab.heard_at > kTabSilentMs) this.remove(number);
    this.run((at) => this.link.tick(at));
  }
}
