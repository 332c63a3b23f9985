// SPDX-License-Identifier: Apache-2.0
// One connection to the bus, kept up. Each connection is a client of its own: mqtt.js would deliver a command of a broken
// connection seconds later.
'use strict';

const { randomBytes } = require('node:crypto');
const { EventEmitter } = require('node:events');
const { createRequire } = require('node:module');
const { AsipError, Clocks, errorOf, makeRequest, makeTopics, readObject, validBoard, validName } = require('./protocol');
const { Boards, isThere, words } = require('./boards');
const { addressOf, passwordHint } = require('./bus-address');
const { Models, askerOf } = require('./models');
const { VersionChoice } = require('./mqtt-version');
const { Standings } = require('./properties');

const LEASE_SECONDS = 15; // of a demand
const GRACE_SECONDS = 0.5; // for an answer behind the deadline that the agent knows
const HELLO_SECONDS = 5;
const ANSWER_SECONDS = 5; // a broker that did not answer by then may know no MQTT 5, or hang
const MAX_OPEN = 4096;
const BAD_CREDENTIALS = [4, 5, 134, 135]; // of a CONNACK: "bad user or password" and "not authorised", of 3.1.1 and of 5

// npm links a folder without installing what it needs: then Node-RED's own copy does.
function connectOf() {
  for (const from of [__filename, require.main?.filename, process.argv[1]].filter(Boolean)) {
    try {
      return createRequire(from)('mqtt').connect;
    } catch (error) {
      if (error.code !== 'MODULE_NOT_FOUND') throw error;
    }
  }
  throw new Error('the module mqtt is missing: npm install mqtt, in the folder of your Node-RED');
}

const now = () => performance.now() / 1000;

// Events: `connected`, `disconnected` (why), `board` (the board that changed).
class Bus extends EventEmitter {
  // options: brokers (with commas), user, password, ca, root, by; connect: mqtt.connect, for tests.
  constructor(options, connect = connectOf()) {
    super();
    this.setMaxListeners(0);
    this.options = options;
    this.connectTo = connect;
    this.addresses = String(options.brokers || '127.0.0.1').split(',').filter((one) => one.trim()).map((one) => addressOf(one, Boolean(options.ca)));
    if (!this.addresses.length) throw new Error('no broker is given');
    this.client = `node-red-${randomBytes(6).toString('hex')}`;
    this.topics = makeTopics(options.root || 'asip', options.user, this.client);
    this.boards = new Boards();
    this.clocks = new Clocks();
    this.models = new Models();
    this.standings = new Standings(this, now);
    this.ready = false;
    this.open = new Map();
    this.queries = new Map(); // id -> function of the answer
    this.values = new Map(); // topic -> Set of functions
    this.newest = new Map(); // topic -> payload
    this.demands = new Map(); // board -> Map(function -> [service, hz])
    this.count = 0;
    this.place = 0;
    this.versions = this.addresses.map(() => new VersionChoice());
    this.failures = 0;
    this.faults = 0;
    this.faulty = new Set();
  }

  // Each who listens is called, whatever the others throw.
  emit(event, ...args) {
    for (const listener of this.rawListeners(event)) this.guard(`what ${event} tells`, () => listener.apply(this, args));
    return true;
  }

  start() {
    this.closed = false;
    this.timer = setInterval(() => this.guard('a turn of the clock', () => this.tick()), 1000);
    this.begin();
  }

  begin() {
    if (this.closed) return;
    this.choice = this.versions[this.place];
    const { v5 } = this.choice;
    this.version = v5 ? 5 : 4;
    const link = this.connectTo(this.addresses[this.place], {
      clientId: `asip-node-red-${randomBytes(8).toString('hex')}`, // published nowhere
      protocolVersion: this.version, clean: true, reconnectPeriod: 0, connectTimeout: 30000, keepalive: 10, queueQoSZero: false, resubscribe: false,
      username: this.options.user || undefined, password: this.options.password || undefined, ca: this.options.ca,
      ...(this.version === 5 ? { properties: { maximumPacketSize: 2 << 20 } } : {}),
    });
    this.link = link;
    const attempt = { v5, accepted: false, how: 'closed', why: '' };
    const silent = setTimeout(() => {
      Object.assign(attempt, { how: link.stream?.connecting ? 'other' : 'silent', why: 'the broker does not answer' });
      link.end(true);
    }, ANSWER_SECONDS * 1000);
    link.on('connect', () => {
      clearTimeout(silent);
      if (this.closed || link !== this.link) { // given up, or the flow has ended
        link.end(true);
        return;
      }
      attempt.accepted = true;
      this.choice.accepted();
      link.stream?.setNoDelay?.(true);
      this.boards.connected(now());
      link.subscribe([this.topics.replies(), this.topics.description('+'), this.topics.state('+')], { qos: 1 });
      for (const topic of this.values.keys()) link.subscribe(topic, { qos: 0 });
      if (this.standings.all.size) link.subscribe(this.standings.topics(), { qos: 1 });
      link.publish(this.topics.own(), 'hello', { qos: 1 });
      this.hello = setTimeout(() => this.drop(link, 'the broker keeps answers from this user: see its access rules'), HELLO_SECONDS * 1000);
    });
    link.on('message', (topic, payload, packet) => this.guard(`a message on ${topic}`, () => this.onMessage(topic, payload, packet)));
    link.on('error', (error) => {
      // A code is that of a CONNACK (those of 3.1.1 are below 128), or a word of the network; without one a packet was none of this version.
      if (v5 && (error.code === undefined || error.code === 132 || error.code < 128)) attempt.how = 'version';
      else if (error.code !== 'ECONNRESET') attempt.how = 'other';
      attempt.why = error.message + (BAD_CREDENTIALS.includes(error.code) ? passwordHint(this.options.password) : '');
      link.end(true);
    });
    link.on('close', () => {
      clearTimeout(silent);
      this.onClose(link, attempt);
    });
  }

  drop(link, why) {
    this.why = why;
    link.end(true);
  }

  onClose(link, attempt) {
    if (link !== this.link) return;
    clearTimeout(this.retry);
    if (!attempt.accepted) this.choice.failed(attempt.how, attempt.v5);
    const atOnce = !attempt.accepted && attempt.how === 'version' && attempt.v5;
    clearTimeout(this.hello);
    this.link = null;
    this.ready = false;
    this.boards.disconnected();
    this.failures += 1;
    if (!this.choice.suspected && !atOnce) this.place = (this.place + 1) % this.addresses.length;
    for (const call of this.open.values()) {
      call.end(errorOf({ status: 'timeout', reason: 'connection' }, call.board, call.service));
    }
    this.emit('disconnected', this.why || attempt.why || 'the connection to the broker ended');
    this.why = undefined;
    if (this.closed) return;
    const wait = atOnce || this.failures < this.addresses.length ? 0 : Math.min(5000, 200 * 2 ** Math.min(this.failures, 6)) * (0.5 + Math.random() / 2);
    this.retry = setTimeout(() => this.begin(), wait);
  }

  // Ends what waits; calls done() within a second, once.
  close(whenDone = () => {}) {
    let isDone = false;
    const done = () => {
      if (!isDone) whenDone();
      isDone = true;
    };
    this.closed = true;
    clearInterval(this.timer);
    clearTimeout(this.retry);
    clearTimeout(this.hello);
    const link = this.link;
    if (!link) return done();
    if (this.ready) for (const board of this.demands.keys()) this.publish(this.topics.demand(board), { services: {}, lease: LEASE_SECONDS }, LEASE_SECONDS, 0);
    const kill = setTimeout(() => {
      link.end(true);
      this.onClose(link, { accepted: true });
      done();
    }, 800);
    link.end(false, {}, () => { clearTimeout(kill); done(); });
    return undefined;
  }

  publish(topic, content, seconds, qos = 1) {
    const properties = this.version === 5 ? { messageExpiryInterval: Math.max(1, Math.ceil(seconds)) } : undefined;
    this.link.publish(topic, JSON.stringify(content), { qos, properties }, () => {});
  }

  // Asks `board` and resolves to its answer when it is proven; rejects with an AsipError. `service` null: the board itself.
  command(board, service, members, { timeout = 5, hold, by = this.options.by } = {}) {
    const where = service ? `${board}/${service}` : board;
    const names = { board, service };
    if (!validBoard(String(board)) || (service && !validName(String(service)))) {
      return Promise.reject(new AsipError('Invalid', `${where}: no name of a board and its service`, { ...names, reason: 'invalid' }));
    }
    try {
      JSON.stringify(members);
    } catch (error) {
      return Promise.reject(new AsipError('Invalid', `${where}: the arguments cannot be written as JSON: ${error.message}`, { ...names, reason: 'invalid' }));
    }
    if (!this.ready) return Promise.reject(new AsipError('Disconnected', `${where}: not connected to a broker; nothing was sent`, names));
    const known = this.boards.get(board);
    if (known && known.state !== 'unknown' && !isThere(known)) {
      return Promise.reject(new AsipError('NotThere', `${where}: ${board} is ${words(known, now())}; nothing was sent`, { ...names, reason: 'board-not-there' }));
    }
    if (this.open.size >= MAX_OPEN) return Promise.reject(new AsipError('Refused', `${where}: ${MAX_OPEN} commands wait already`, { ...names, reason: 'queue-full' }));
    const id = `${this.client}-${this.count += 1}`;
    const asked = now();
    const request = makeRequest(members, { replyTo: this.topics.reply(board), id, timeout, clock: this.clocks.reading(board, asked), by, hold });
    return new Promise((resolve, reject) => {
      const call = {
        board, service, where, asked,
        end: (error, answer) => {
          clearTimeout(call.timer);
          this.open.delete(id);
          if (error) reject(error); else resolve(answer);
        },
      };
      call.timer = setTimeout(() => call.end(errorOf({ status: 'timeout', reason: 'no-answer' }, board, service)),
        (timeout + GRACE_SECONDS) * 1000);
      this.open.set(id, call);
      this.publish(service ? this.topics.command(board, service) : this.topics.lines(board), request, timeout);
    });
  }

  // The model of a service of a board; undefined where none is known.
  modelOf(board, service) {
    return this.models.of(this.boards.get(board)?.description.services.find((one) => one.name === service));
  }

  // Asks a registry for the models that a description refers to and this package does not have.
  learn(description) {
    const kind = this.ready ? this.models.unknown(description) : [];
    for (let first = 0; first < kind.length; first += 32) {
      const id = `${this.client}-${this.count += 1}`;
      const forget = setTimeout(() => this.queries.delete(id), 5000);
      forget.unref?.(); // nothing waits for it
      this.queries.set(id, (answer) => { clearTimeout(forget); this.models.take(answer.items); });
      this.publish(this.topics.query(), { find: 'models', kind: kind.slice(first, first + 32), id, reply_to: this.topics.reply('registry') }, 5);
    }
  }

  // Asks the board for a value that it does not report by itself; resolves to nothing where it cannot be asked.
  async askFor(board, service, event) {
    const asker = askerOf(this.modelOf(board, service), event);
    if (!asker) return undefined;
    const { answer } = await this.command(board, service, { [asker]: [] });
    return answer;
  }

  // Calls `take(payload, retained)` for each report; returns a function that ends it.
  onValue(board, service, hz, take) {
    const topic = this.topics.event(board, service);
    const takers = this.values.get(topic) || new Set();
    this.values.set(topic, takers.add(take));
    if (takers.size === 1 && this.link?.connected) this.link.subscribe(topic, { qos: 0 });
    const demands = this.demands.get(board) || new Map();
    this.demands.set(board, demands.set(take, [service, hz]));
    this.demand(board);
    if (this.newest.has(topic)) setImmediate(() => takers.has(take) && this.guard(`a value on ${topic}`, () => take(structuredClone(this.newest.get(topic)), true)));
    return () => {
      takers.delete(take);
      demands.delete(take);
      if (takers.size === 0) {
        this.values.delete(topic);
        this.newest.delete(topic);
        if (this.link?.connected) this.link.unsubscribe(topic);
      }
      this.demand(board);
    };
  }

  // Says what is wanted of a board that reports on demand.
  demand(board) {
    const demands = this.demands.get(board);
    const known = this.boards.get(board);
    if (!this.ready || !demands || !known?.description.on_demand) return;
    const services = {};
    for (const [service, hz] of demands.values()) services[service] = Math.max(hz, services[service] || 0);
    this.publish(this.topics.demand(board), { services, lease: LEASE_SECONDS }, LEASE_SECONDS);
    if (demands.size === 0) this.demands.delete(board);
  }

  // Whatever arrives: what raises is counted, told once as `fault`, and dropped.
  guard(what, action) {
    try {
      action();
    } catch (error) {
      this.faults += 1;
      const kind = String(error?.stack || error).split('\n').slice(0, 2).join(' ');
      if (this.faulty.has(kind) || this.faulty.size >= 100) return;
      this.faulty.add(kind);
      this.emit('fault', `${what} was dropped; others of this kind will be without a line here: ${kind}`);
    }
  }

  onMessage(topic, payload, packet) {
    const levels = this.topics.split(topic);
    if (!levels) return;
    if (topic === this.topics.own()) this.onReady();
    else if (levels[0] === 'reply') this.onReply(topic, payload);
    else if (this.standings.take(topic, payload, packet.retain)) return;
    else if (levels[0] === 'servicebus' && levels.length === 3) {
      const expiry = packet.properties?.messageExpiryInterval;
      this.changed(levels[2] === '$state' ? this.boards.onState(levels[1], payload, packet.retain, expiry, now())
        : levels[2] === '$description' ? this.boards.onDescription(levels[1], payload, packet.retain, expiry, now()) : undefined);
    } else if (this.values.has(topic)) {
      const value = readObject(payload);
      if (!value) return;
      this.newest.set(topic, value);
      for (const take of [...this.values.get(topic)]) this.guard(`a value on ${topic}`, () => take(structuredClone(value), false)); // flows change what they get
    }
  }

  onReady() {
    if (this.ready) return;
    clearTimeout(this.hello);
    this.ready = true;
    this.failures = 0;
    for (const board of this.demands.keys()) this.demand(board);
    for (const board of this.boards.all.values()) this.learn(board.description);
    this.emit('connected');
  }

  onReply(topic, payload) {
    const answer = readObject(payload);
    if (answer && topic === this.topics.reply('registry')) {
      this.queries.get(answer.id)?.(answer);
      this.queries.delete(answer.id);
      return;
    }
    const call = answer && typeof answer.id === 'string' ? this.open.get(answer.id) : undefined;
    if (!call || topic !== this.topics.reply(call.board)) return;
    this.clocks.note(call.board, answer.clock, call.asked, now());
    call.end(errorOf(answer, call.board, call.service), answer);
  }

  changed(board) {
    if (!board) return;
    this.learn(board.description);
    if (this.demands.has(board.name)) this.demand(board.name);
    this.emit('board', board);
  }

  tick() {
    for (const board of this.boards.expire(now())) this.changed(board);
    this.ticks = (this.ticks || 0) + 1;
    if (this.ticks % (LEASE_SECONDS / 3) === 0) for (const board of this.demands.keys()) this.demand(board);
  }
}

module.exports = { Bus, now };
