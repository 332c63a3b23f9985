// SPDX-License-Identifier: Apache-2.0
// A board in this computer: the page carries bytes between its serial port (Web Serial) and an agent beside the gateway. Loaded when
// *Add board* is opened. A cable goes on while its tab is open, whatever screen is shown.
import { base } from "../net/bus.js";
import { h, muted, page_of, Part, set_text } from "../ui/dom.js";
import { status } from "../ui/model.js";

const kStartBaud = 57600;
const kBufferBytes = 16384;
const kDtrLowMs = 100;
const kAgainMs = 2000; // at first
const kAgainMaxMs = 10_000;
const kSilentMs = 5000; // the gateway says something every second
const kCheckMs = 1000;
const kConnectMs = 10_000; // more, until there is a connection
const kMaxWaiting = 262_144; // bytes, in either direction, as in the gateway
const kForGood = [1008, 4001]; // closed by the gateway: not allowed, or another cable has its place

const texts = await fetch(new URL(`languages/${document.documentElement.lang}.json`, import.meta.url)).then((response) => response.json());
/// As t(), of the table of this folder.
const say = (name, values = {}) => texts[name].replace(/\{(\w+)\}/g, (_, key) => values[key]);

const later = (ms) => new Promise((done) => { setTimeout(done, ms); });
const hex = (number) => number.toString(16).padStart(4, "0");
const bytes_of = (kind, payload = new Uint8Array()) => {
  const message = new Uint8Array(1 + payload.length);
  message[0] = kind.charCodeAt(0);
  message.set(payload, 1);
  return message;
};

const cables = new Set();
const changes = new EventTarget();

class Cable {
  constructor(port) {
    this.port = port;
    this.pause = kAgainMs;
    this.name = [...crypto.getRandomValues(new Uint16Array(4))].map(hex).join(""); // the gateway knows it again by that
    this.show("cable.opening");
    cables.add(this);
    this.connect();
  }

  /// `board`: whose page is linked.
  show(name, values, board) {
    Object.assign(this, { text: say(name, values), board });
    changes.dispatchEvent(new Event("change"));
  }

  address() {
    const url = new URL("api/cable", base);
    url.protocol = url.protocol.replace("http", "ws");
    const { usbVendorId, usbProductId } = this.port.getInfo();
    url.search = new URLSearchParams({ cable: this.name, ...(usbVendorId !== undefined && { vendor: hex(usbVendorId), product: hex(usbProductId) }) });
    return url;
  }

  connect() {
    this.todo = Promise.resolve();
    this.waiting = 0;
    this.heard = Date.now() + kConnectMs; // a clock that goes on while a computer sleeps
    const socket = this.socket = new WebSocket(this.address());
    socket.binaryType = "arraybuffer";
    // The port is opened when the agent is there: it hears the board's first words.
    socket.onopen = () => {
      this.heard = Date.now();
      this.then(async () => {
        await this.open(kStartBaud);
        this.show("cable.asking");
      });
    };
    socket.onmessage = ({ data }) => { if (this.socket === socket) this.received(data, socket); };
    socket.onclose = ({ code }) => { if (this.socket === socket) this.leave(code); };
  }

  /// What comes behind a silence was sent long ago: no board executes a command that late.
  received(data, socket) {
    if (!this.check()) return undefined;
    this.heard = Date.now();
    this.waiting += data.byteLength;
    if (this.waiting > kMaxWaiting) return this.fail(new Error(say("cable.slow")));
    return this.then(async () => {
      const kind = String.fromCharCode(new Uint8Array(data, 0, 1)[0]);
      if (this.socket === socket || kind === "E") await this.take(kind, new Uint8Array(data, 1));
      this.waiting -= data.byteLength;
    });
  }

  /// The connection counts for nothing from now on. Without a network its own end would come minutes later. What the port has not
  /// taken yet is dropped: no board executes a command when its cable has ended.
  leave(code) {
    this.socket?.close();
    this.socket = undefined;
    this.aborted = this.writer?.abort().catch(() => undefined);
    this.then(async () => {
      await this.close();
      if (this.over || kForGood.includes(code)) return this.end();
      if (!this.why) this.show("cable.again");
      await later(this.pause);
      this.pause = Math.min(2 * this.pause, kAgainMaxMs);
      if (this.over) return this.end();
      if (await may_lend()) return this.connect();
      this.show("cable.not-allowed");
      return this.end();
    });
  }

  /// False: it was silent for too long, and is left.
  check() {
    const silent = this.socket && Date.now() - this.heard > kSilentMs;
    if (silent) this.leave();
    return !silent;
  }

  /// One thing after the other: what is behind a change of the rate waits for that.
  then(work) {
    this.todo = this.todo.then(work).catch((error) => this.fail(error));
  }

  fail(error) {
    if (this.over) return;
    this.show("cable.failed", { why: error.message });
    this.stop();
  }

  async take(kind, payload) {
    if (this.over) return undefined;
    const text = () => new TextDecoder().decode(payload);
    if (kind === "D") return this.write(payload);
    if (kind === "R") {
      await this.close();
      return this.open(Number(text()));
    }
    if (kind === "Z") return this.restart();
    if (kind === "N") {
      this.pause = kAgainMs;
      return this.show("cable.lent", {}, text());
    }
    if (kind === "E") this.show("cable.ended", { why: this.why = text() });
    return undefined;
  }

  async open(baudRate) {
    await this.port.open({ baudRate, bufferSize: kBufferBytes });
    this.why = "";
    this.reads = true;
    this.reading = this.read();
  }

  /// All that was written leaves first.
  async close() {
    this.reads = false;
    await this.aborted;
    await this.reader?.cancel().catch(() => undefined);
    await this.reading;
    await this.port.writable?.getWriter().close().catch(() => undefined);
    await this.port.close().catch(() => undefined);
  }

  async write(payload) {
    const writer = this.writer = this.port.writable?.getWriter();
    try {
      await writer?.write(payload);
    } catch (error) {
      if (this.socket) throw error; // else leave() ended it
    } finally {
      this.writer = undefined;
      writer?.releaseLock();
    }
  }

  async restart() {
    await this.port.setSignals({ dataTerminalReady: false, requestToSend: false });
    await later(kDtrLowMs);
    await this.port.setSignals({ dataTerminalReady: true, requestToSend: true });
  }

  /// Damaged bytes end a reader, and not the port; a board that is pulled ends both.
  async read() {
    while (this.reads && this.port.readable) {
      this.reader = this.port.readable.getReader();
      try {
        for (;;) {
          const { value, done } = await this.reader.read();
          if (done) break;
          this.send("D", value);
        }
      } catch { /* the next reader goes on, where there is one */ } finally {
        this.reader.releaseLock();
      }
    }
    if (this.reads) this.pulled();
  }

  send(kind, payload) {
    if (this.socket?.readyState !== WebSocket.OPEN) return;
    if (this.socket.bufferedAmount > kMaxWaiting) this.leave();
    else this.socket.send(bytes_of(kind, payload));
  }

  pulled() {
    this.show("cable.pulled");
    this.send("E");
    this.stop();
  }

  /// By a person, or since the port is gone.
  stop() {
    this.over = true;
    this.leave();
  }

  end() {
    this.over = true;
    this.ended = true;
    changes.dispatchEvent(new Event("change"));
  }
}

class Lend extends Part {
  shown() {
    this.rows = new Map();
    this.list = h("ul", { class: "link-list", "aria-live": "polite" });
    if (this.titled) this.append(h("h3", {}, say("cable.connect")));
    this.what = h("p", {});
    this.append(this.what, this.list);
    this.listen(changes, "change", () => this.draw());
    this.listen(status, "change", () => this.draw());
    this.draw();
  }

  draw() {
    this.what.hidden = status.you.lend !== true;
    this.hidden = this.what.hidden && cables.size === 0;
    const able = navigator.serial !== undefined;
    if (!this.what.firstChild)
      this.what.append(...able
        ? [muted(say("cable.about")), h("button", { class: "main", onclick: () => this.choose() }, say("cable.choose"))]
        : [say(isSecureContext ? "cable.no-serial" : "cable.not-secure")]);
    for (const [cable, { item }] of this.rows) {
      if (cables.has(cable)) continue;
      item.remove();
      this.rows.delete(cable);
    }
    for (const cable of cables) this.draw_row(cable);
  }

  /// A row stays the same elements: what a person is about to press does not go away.
  draw_row(cable) {
    if (!this.rows.has(cable)) {
      const row = { text: h("span", {}), link: h("a", {}), button: h("button", { onclick: () => this.remove(cable) }) };
      this.rows.set(cable, { ...row, item: h("li", {}, row.text, " ", row.link, " ", row.button) });
      this.list.append(this.rows.get(cable).item);
    }
    const { text, link, button } = this.rows.get(cable);
    set_text(text, cable.text);
    link.hidden = !cable.board;
    link.href = cable.board ? page_of("board", cable.board) : "";
    set_text(link, cable.board ?? "");
    set_text(button, say(cable.ended ? "cable.remove" : "cable.disconnect"));
  }

  async choose() {
    const port = await navigator.serial.requestPort().catch(() => undefined); // a person chose none
    if (port) lend(port);
  }

  remove(cable) {
    cable.stop();
    cables.delete(cable);
    this.draw();
  }
}

/// False: the gateway says that this browser may not; a gateway that says nothing is asked again later.
async function may_lend() {
  await status.refresh();
  return status.now ? status.you.lend === true : !status.refused;
}

/// What it was lent by before closes the port first.
async function lend(port) {
  const before = [...cables].find((cable) => cable.port === port);
  if (before && !before.over) return;
  await before?.todo;
  if (before && !cables.delete(before)) return; // it was lent again meanwhile
  new Cable(port);
}

setInterval(() => { for (const cable of cables) cable.check(); }, kCheckMs);

// Another document comes into this tab. Browsers may keep this one for *Back*, with its sockets.
addEventListener("pagehide", () => {
  for (const cable of cables) cable.stop();
});

// A board that this tab lent is plugged in again.
navigator.serial?.addEventListener("connect", ({ target }) => {
  if ([...cables].some((cable) => cable.port === target)) lend(target);
});

customElements.define("asip-lend", Lend);

/// Offers it ahead of an element. `titled`: with a heading of its own.
export function offer(before, titled = true) {
  before.before(Object.assign(document.createElement("asip-lend"), { titled }));
}
