# SPDX-License-Identifier: Apache-2.0
"""Serial ports of simulated boards for a page: `FAKE_SERIAL` is a navigator.serial whose ports are opened, written and read here, over a
WebSocket for each port. It opens, closes and restarts as Chromium does at a real port."""

import base64
import hashlib
import json
import os
import select
import socket
import threading
import time

from lent_board import Port
from websocket import ABNF
from websocket._abnf import frame_buffer

# Ports stand in window.fake_ports by their names; a test chooses by window.next_port, as a person does in Chromium's dialog.
FAKE_SERIAL = """
(() => {
  const server = "ws://PLACE/";
  class FakePort extends EventTarget {
    #socket; #readable; #writable; #gone = false;
    constructor(name) { super(); this.name = name; }
    getInfo() { return { usbVendorId: 0x1a86, usbProductId: 0x7523 }; }
    async open({ baudRate }) {
      if (this.#socket) throw new DOMException("The port is already open.", "InvalidStateError");
      const socket = new WebSocket(server + this.name);
      socket.binaryType = "arraybuffer";
      await new Promise((done, failed) => { socket.onopen = done; socket.onerror = () => failed(new DOMException("Failed to open serial port.", "NetworkError")); });
      this.#gone = false;
      this.#socket = socket;
      addEventListener("pagehide", () => socket.close());
      const answers = this.answers = [];
      socket.onmessage = ({ data }) => { if (typeof data === "string") answers.shift()?.(); else this.controller?.enqueue(new Uint8Array(data)); };
      socket.onclose = () => this.#lost(socket);
      await this.#ask({ open: baudRate });
    }
    #ask(what) {
      return new Promise((done) => { this.answers.push(done); this.#socket.send(JSON.stringify(what)); });
    }
    #lost(socket) {
      if (this.#socket !== socket) return;
      this.#gone = true;
      this.#socket = undefined;
      this.controller?.error(new DOMException("The device has been lost.", "NetworkError"));
      this.#readable = this.#writable = undefined;
    }
    get readable() {
      if (!this.#socket || this.#gone) return null;
      return this.#readable ??= new ReadableStream({
        start: (controller) => { this.controller = controller; },
        cancel: () => { this.#readable = this.controller = undefined; },
      });
    }
    get writable() {
      if (!this.#socket || this.#gone) return null;
      return this.#writable ??= new WritableStream({
        // A test lets it wait by a promise in window.stalled; abort() ends that, as in Chromium.
        write: async (bytes, controller) => {
          await Promise.race([window.stalled, new Promise((done) => controller.signal.addEventListener("abort", done))]);
          if (!controller.signal.aborted) this.#socket?.send(bytes);
        },
        close: () => { this.#writable = undefined; },
        abort: () => { this.#writable = undefined; },
      });
    }
    async setSignals(signals) { if (signals.dataTerminalReady !== undefined) await this.#ask({ dtr: signals.dataTerminalReady }); }
    async close() {
      if (!this.#socket) throw new DOMException("The port is already closed.", "InvalidStateError");
      if (this.#readable) await this.#readable.cancel();
      if (this.#writable) await this.#writable.abort();
      await this.#ask({ close: true });
      const socket = this.#socket;
      this.#socket = undefined;
      socket.close();
    }
  }
  window.fake_ports = {};
  const serial = new EventTarget();
  serial.requestPort = async () => (window.fake_ports[window.next_port] ??= new FakePort(window.next_port));
  window.plug_again = (name) => serial.dispatchEvent(Object.defineProperty(new Event("connect"), "target", { value: window.fake_ports[name] }));
  Object.defineProperty(navigator, "serial", { value: serial, configurable: true });
})();
"""


class PortServer:
    """`host`: that of the page. Browsers let no page of another machine reach 127.0.0.1."""

    def __init__(self, folder, host="127.0.0.1"):
        self.folder = folder
        self.opened = {}  # rates, by the name of the port
        self.restarts = {}
        self.listener = socket.create_server((host, 0))
        self.script = FAKE_SERIAL.replace("PLACE", f"{host}:{self.listener.getsockname()[1]}")
        threading.Thread(target=self.accept, daemon=True).start()

    def close(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()

    def accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)  # a real port holds nothing back
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    def serve(self, connection):
        with connection:
            head = b""
            while b"\r\n\r\n" not in head:
                head += connection.recv(4096)
            lines = head.decode().split("\r\n")
            name = lines[0].split()[1].lstrip("/")
            key = next(line.split(": ")[1] for line in lines if line.lower().startswith("sec-websocket-key"))
            accepted = base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()).decode()
            port = Port(str(self.folder / f"{name}.port"))
            if not os.path.exists(port.path):
                return
            connection.sendall(f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accepted}\r\n\r\n".encode())
            try:
                self.carry(connection, name, port)
            except OSError:  # the page or the board is gone
                pass
            finally:
                port.close()

    def carry(self, connection, name, port):
        frames = frame_buffer(connection.recv, True)
        send = lambda data, code: connection.sendall(ABNF(1, 0, 0, 0, code, 0, data).format())
        while True:
            ready, _, _ = select.select([connection, *([port.fd] if port.fd is not None else [])], [], [])
            if port.fd in ready:
                time.sleep(0.001)  # USB brings what came in a millisecond, not each byte
                data = os.read(port.fd, 4096)
                if not data:
                    return
                send(data, ABNF.OPCODE_BINARY)
            if connection not in ready:
                continue
            frame = frames.recv_frame()
            if frame.opcode == ABNF.OPCODE_BINARY:
                port.write(frame.data)
            elif frame.opcode == ABNF.OPCODE_TEXT:
                self.do(json.loads(frame.data), name, port)
                send(b"done", ABNF.OPCODE_TEXT)
            else:
                return

    def do(self, asked, name, port):
        if "open" in asked:
            port.open(asked["open"])
            self.opened.setdefault(name, []).append(asked["open"])
        elif "close" in asked:
            port.close()
        elif asked["dtr"]:  # rises: a simulated board restarts where its port is opened
            self.restarts[name] = self.restarts.get(name, 0) + 1
            baud = port.opened[-1]
            port.close()
            port.open(baud)
