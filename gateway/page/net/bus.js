// SPDX-License-Identifier: Apache-2.0
// What a tab knows of the gateway: subscriptions, commands, requests.
import { known_text, locale, t } from "../core/language.js";
import { says_more } from "../core/form.js";
import { answer_ms } from "../core/link.js";
import { named } from "../core/text.js";
import { Hub } from "./hub.js";

export const base = new URL("../", import.meta.url);
const kHeartbeatMs = 60_000;

class Bus extends EventTarget {
  constructor() {
    super();
    this.link = { state: "connecting", since: Date.now(), was_open: false };
    this.listeners = new Map(); // ref -> {request, listener}
    this.waiting = new Map();   // id -> resolve
    this.next = 1;
    this.prefix = Math.random().toString(36).slice(2, 8);
    this.connect();
    setInterval(() => this.port.postMessage({ alive: true }), kHeartbeatMs);
    addEventListener("pagehide", () => this.port.postMessage({ bye: true }));
    addEventListener("pageshow", (event) => { if (event.persisted) this.connect(); });
    document.addEventListener("visibilitychange", () => { if (!document.hidden) this.hurry(); });
  }

  connect() {
    this.port = open_port();
    this.port.onmessage = (event) => event.data.forEach((message) => this.received_safely(message));
    for (const [ref, { request }] of this.listeners) this.port.postMessage({ subscribe: request, ref });
  }

  /// What one listener cannot read takes nothing from the others.
  received_safely(message) {
    try {
      this.received(message);
    } catch (error) {
      console.error("a message was not understood", message, error);
    }
  }

  received(message) {
    if (message.link) {
      this.link = message.link;
      this.dispatchEvent(new Event("link"));
    } else if (message.expired) {
      for (const [ref, { listener }] of this.listeners) listener({ ref, event: "reset" });
      this.connect();
    } else if (message.ref !== undefined) {
      this.listeners.get(Number(message.ref))?.listener(message);
    } else if (message.id !== undefined) {
      this.answered(message);
    }
  }

  answered(message) {
    const resolve = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.status === undefined) message = { status: "refused", reason: "invalid", error: message.error };
    resolve?.(message);
  }

  /// `listener` gets each event; the returned function ends it.
  subscribe(request, listener) {
    const ref = this.next++;
    this.listeners.set(ref, { request, listener });
    this.port.postMessage({ subscribe: request, ref });
    return () => {
      if (this.listeners.delete(ref)) this.port.postMessage({ unsubscribe: ref });
    };
  }

  /// {answer, ...}: `answer` is a promise of the bus's answer; it always comes. `renew` keeps a command with `hold_ms` in force
  /// until `release`; should it not be held any more before that, `lost` gets the reason.
  command(board, service, name, args, more = {}) {
    const id = `${this.prefix}-${this.next++}`;
    const command = `${board}/${service}`;
    const answer = new Promise((resolve) => this.waiting.set(id, resolve));
    this.port.postMessage({ command: { command, [name]: args, ...more }, id });
    return {
      answer,
      renew: (lost) => {
        this.waiting.set(id, lost);
        this.port.postMessage({ renew: { command }, id });
      },
      release: () => {
        this.waiting.delete(id);
        this.port.postMessage({ release: id });
      },
    };
  }

  /// This browser has other rights from now on.
  anew() { this.port.postMessage({ anew: true }); }

  hurry() { this.port.postMessage({ hurry: true }); }
}

function open_port() {
  if ("SharedWorker" in self) {
    try {
      return new SharedWorker(script_url("net/worker.js"), { type: "module", name: "asip" }).port;
    } catch (error) {
      console.warn("no shared worker, so this tab has a connection of its own", error);
    }
  }
  const { port1, port2 } = new MessageChannel();
  own_hub ??= new Hub(new URL("api/", base).href);
  own_hub.add(port2);
  return port1;
}
let own_hub;

/// The address of a script of ours, for what runs beside the page.
export function script_url(path) {
  const url = new URL(path, base).href;
  policy ??= self.trustedTypes?.createPolicy("page", { createScriptURL: (text) => text });
  return policy ? policy.createScriptURL(url) : url;
}
let policy;

export class Problem extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

const exact = [400, 409]; // beside the sentence of these it is told in English what exactly

/// Why the gateway did not do it. Its own sentence is English: others read that of their table first.
function problem_text(path, status, json) {
  const { detail, title, reason } = json ?? {};
  const told = detail ?? title ?? t("gateway-answers", { status });
  if (locale.startsWith("en")) return told;
  const own = known_text(`status.${path.split("/")[1]}.${status}`) ?? known_text(`status.${reason}`) ?? known_text(`answer.refused.${reason}`);
  const known = own ?? known_text(`status.${status}`) ?? told;
  return detail && (own ? says_more(reason) : exact.includes(status)) ? `${known} (${detail})` : known;
}

/// What the gateway answers as JSON; throws a Problem with a sentence for people.
export async function request(path, options) { return (await request_with_tag(path, options)).body; }

/// The same with the version of what it answers: {body, tag}.
export async function request_with_tag(path, { method = "GET", body, headers = {} } = {}) {
  let response;
  try {
    response = await fetch(new URL(path, base), {
      method,
      headers: body === undefined ? headers : { "Content-Type": "application/json", ...headers },
      body: body === undefined ? undefined : JSON.stringify(body),
      signal: AbortSignal.timeout(answer_ms(path)),
    });
  } catch {
    throw new Problem(0, t("gateway-does-not"));
  }
  const json = await response.json().catch(() => undefined);
  if (response.ok) return { body: json, tag: response.headers.get("ETag") ?? undefined };
  throw Object.assign(new Problem(response.status, problem_text(path, response.status, json)), { reason: json?.reason });
}

export const path_of = (...parts) => "api/" + parts.map(encodeURIComponent).join("/");

/// What can be read and set on a board.
export const properties_of = async (board) => (await request(path_of("boards", board, "properties"))).properties.map(named);
export const bus = new Bus();
