// SPDX-License-Identifier: Apache-2.0
// The connection to the gateway, kept up: a state machine. Inputs are method calls with the time in milliseconds, outputs
// are what `take_actions` gives: {open}, {close}, {send: object}, {state}, {deliver: message}, {fetch: id}: ask what became of
// a command.

const kFirstWaitMs = 400;
const kMaxWaitMs = 10_000;
const kOpenTimeoutMs = 10_000;
const kQuietMs = 45_000;  // then something is asked, to learn whether the connection is alive
const kAnswerMs = 10_000; // so long that may take
const kCommandGraceMs = 10_000; // beyond the deadline of a command
const kFetchAgainMs = 500; // its answer is not there yet
const kRefusedMs = 1500; // a refused subscription (no broker yet) is tried again

/// How long an answer to a request may take: what its path lets the gateway take, by `deadline_ms` or `wait`, and the way.
export function answer_ms(path) {
  const asked = new URLSearchParams(path.split("?", 2)[1] ?? "");
  const most = Math.max(5000, Number(asked.get("deadline_ms")) || 0, 1000 * Number(asked.get("wait")) || 0);
  return most + kCommandGraceMs;
}

export class Link {
  constructor(random = Math.random) {
    this.random = random;
    this.state = "idle"; // idle, connecting, open, waiting
    this.since = 0;
    this.actions = [];
    this.subscriptions = new Map(); // ref -> {request, place}
    this.commands = new Map();      // id -> {until, held}
    this.cut = new Map();           // id -> {until, fetch_at}: their connection was lost, their outcome is not known yet
    this.held = new Set();          // ids of commands that are renewed
    this.failures = 0;
    this.heard_at = 0;
    this.asked_at = undefined;
    this.retry_at = 0;
  }

  take_actions() {
    const { actions } = this;
    this.actions = [];
    return actions;
  }

  start(now) {
    if (this.state === "idle") this.connect(now);
  }

  connect(now) {
    this.set_state("connecting", now);
    this.actions.push({ open: true });
  }

  set_state(state, now) {
    this.state = state;
    this.since = now;
    this.actions.push({ state });
  }

  opened(now) {
    if (this.state !== "connecting") return;
    this.set_state("open", now);
    this.heard_at = now;
    this.asked_at = undefined;
    for (const [ref, subscription] of this.subscriptions) this.send_subscription(ref, subscription);
    for (const [id, command] of this.cut) this.fetch(id, command);
  }

  fetch(id, command) {
    command.fetch_at = undefined;
    this.actions.push({ fetch: id });
  }

  /// The answer to {fetch: id}. `record`: as the gateway has it; null: it does not know the command; undefined: it did not answer.
  fetched(id, record, now) {
    const command = this.cut.get(id);
    if (!command) return;
    if (record === null) this.lost(id);
    else if (record?.answer) this.settle(id, { ...record.answer, id });
    else command.fetch_at = now + kFetchAgainMs;
  }

  settle(id, answer) {
    this.cut.delete(id);
    this.deliver(answer);
  }

  lost(id) { this.settle(id, { id, status: "timeout", reason: "connection" }); }

  send_subscription(ref, subscription) {
    const { request, place, sent } = subscription;
    if (sent && !place) this.deliver({ ref, event: "reset", reason: "connection" }); // cut within its snapshot
    subscription.sent = true;
    subscription.again_at = undefined;
    this.actions.push({ send: place ? { ...request, ref, after: place } : { ...request, ref } });
  }

  subscribe(ref, request) {
    const subscription = { request, place: undefined, sent: false };
    this.subscriptions.set(ref, subscription);
    if (this.state === "open") this.send_subscription(ref, subscription);
  }

  unsubscribe(ref) {
    if (this.subscriptions.delete(ref) && this.state === "open") this.actions.push({ send: { unsubscribe: ref } });
  }

  /// Exactly one answer is delivered, whatever happens. Without a connection the command is refused: it must not be sent
  /// at some later moment when the user does not expect it any more.
  command(id, request, now) {
    if (this.state !== "open") {
      this.deliver({ id, status: "refused", reason: "connection" });
      return;
    }
    this.commands.set(id, { until: now + (request.deadline_ms ?? 5000) + kCommandGraceMs, held: request.hold_ms !== undefined });
    this.actions.push({ send: { ...request, id } });
  }

  /// Keeps a command with `hold_ms` in force. There is an answer, of the command's own id, only once it is not held any more.
  renew(id, request) {
    if (this.state !== "open") return;
    this.held.add(id);
    this.actions.push({ send: { ...request, id, renew: true } });
  }

  received(message, now) {
    if (this.state !== "open") return;
    this.heard_at = now;
    this.asked_at = undefined;
    this.failures = 0;
    if (message.ref !== undefined) {
      const subscription = this.subscriptions.get(message.ref);
      if (!subscription) return; // on its way when it was given up
      if (message.error) subscription.again_at = now + kRefusedMs;
      if (message.event === "reset") subscription.place = undefined;
      else if (message.place) subscription.place = message.place;
    } else if (message.id !== undefined) {
      if (!this.commands.delete(message.id) && !this.held.delete(message.id)) return;
    }
    this.deliver(message);
  }

  closed(now) {
    if (this.state === "idle" || this.state === "waiting") return;
    for (const [id, { until, held }] of this.commands) {
      if (held) this.lost(id); // it is not renewed meanwhile
      else this.cut.set(id, { until });
    }
    for (const id of this.held) this.deliver({ id, status: "timeout", reason: "connection" });
    this.commands.clear();
    this.held.clear();
    const wait = Math.min(kMaxWaitMs, kFirstWaitMs * 2 ** this.failures) * (0.5 + this.random() / 2);
    this.failures = Math.min(this.failures + 1, 10);
    this.retry_at = now + wait;
    this.set_state("waiting", now);
  }

  /// The network came back, or the user looks at the page again: tries at once.
  hurry(now) {
    if (this.state === "waiting") this.connect(now);
    else if (this.state === "open" && this.asked_at === undefined && now - this.heard_at > kAnswerMs) this.ask(now);
  }

  ask(now) {
    this.asked_at = now;
    this.actions.push({ send: { unsubscribe: "alive?" } }); // any answer will do
  }

  /// Called about once a second.
  tick(now) {
    for (const [id, command] of this.cut) {
      if (now >= command.until) this.lost(id);
      else if (this.state === "open" && now >= command.fetch_at) this.fetch(id, command);
    }
    for (const [id, { until }] of this.commands) {
      if (now < until) continue;
      this.commands.delete(id);
      this.deliver({ id, status: "timeout" });
    }
    for (const [ref, subscription] of this.subscriptions) {
      if (this.state === "open" && now >= subscription.again_at) this.send_subscription(ref, subscription);
    }
    if (this.state === "waiting" && now >= this.retry_at) this.connect(now);
    else if (this.state === "connecting" && now - this.since > kOpenTimeoutMs) this.give_up(now);
    else if (this.state === "open" && this.asked_at !== undefined && now - this.asked_at > kAnswerMs) this.give_up(now);
    else if (this.state === "open" && this.asked_at === undefined && now - this.heard_at > kQuietMs) this.ask(now);
  }

  give_up(now) {
    this.actions.push({ close: true });
    this.closed(now);
  }

  deliver(message) { this.actions.push({ deliver: message }); }
}
