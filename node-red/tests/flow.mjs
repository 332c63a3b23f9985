// SPDX-License-Identifier: Apache-2.0
// The nodes of this package in a flow, without Node-RED and without a broker: what they send, show and log.
import { EventEmitter } from 'node:events';
import { createRequire } from 'node:module';

const require = createRequire(import.meta.url);
const { Bus } = require('../lib/bus.js');

// A broker that answers what this program sends to itself, and remembers the rest.
export class Broker extends EventEmitter {
  sent = [];

  connected = true;

  subscribe() {}

  unsubscribe() {}

  publish(topic, text) {
    if (topic.includes('/$self/')) setImmediate(() => this.tell(topic, text));
    else this.sent.push([topic, JSON.parse(text)]);
  }

  tell(topic, content, retain = false) { this.emit('message', topic, Buffer.from(typeof content === 'string' ? content : JSON.stringify(content)), { retain }); }

  end(_force, _options, done) { setImmediate(() => { this.emit('close'); done?.(); }); }
}

class Node extends EventEmitter {
  constructor(flow, config) {
    super();
    Object.assign(this, { flow, config, shown: undefined });
  }

  status(shown) { this.shown = shown; }

  send(messages) { for (const [output, msg] of [messages].flat().entries()) if (msg) this.flow.sent.push([this.config.id, msg, output]); }

  error(text) { this.flow.errors.push([this.config.id, text]); }

  warn(text) { this.flow.errors.push([this.config.id, text]); }

  log() {}
}

export class Flow {
  broker = new Broker();

  sent = [];

  errors = [];

  faults = [];

  nodes = new Map();

  types = {};

  lists = {};

  // connect: what gives a connection, in place of `broker`.
  constructor(connect) {
    this.bus = new Bus({ brokers: 'pi' }, connect ?? (() => this.broker));
    this.bus.on('fault', (what) => this.faults.push(what));
    const RED = {
      nodes: {
        registerType: (name, make) => { this.types[name] = make; },
        createNode: () => {},
        getNode: (id) => (id === 'bus' ? { bus: this.bus } : undefined),
      },
      auth: { needsPermission: () => undefined },
      httpAdmin: { get: (path, _may, answer) => { this.lists[path.split('/').at(-1)] = answer; } },
      util: { evaluateNodeProperty: (text) => JSON.parse(text) },
    };
    for (const name of ['bus', 'value', 'command', 'pin-in', 'pin-out', 'property-in', 'property-out', 'boards']) require(`../nodes/asip-${name}.js`)(RED);
  }

  async start(configs) {
    this.bus.start();
    this.broker.emit('connect');
    await new Promise((done) => { this.bus.once('connected', done); });
    for (const config of configs) this.add(config);
  }

  add(config) {
    const node = new Node(this, config);
    this.types[config.type].call(node, { bus: 'bus', ...config });
    this.nodes.set(config.id, node);
    return node;
  }

  // What a list of the editor answers.
  list(name, query) {
    let told;
    this.lists[name]({ params: { bus: 'bus' }, query }, { json: (value) => { told = value; }, status: () => ({ json: (value) => { told = value; } }) });
    return JSON.stringify(told);
  }

  // Ends when the node is done with the message.
  input(id, msg) {
    const node = this.nodes.get(id);
    return new Promise((done) => { node.emit('input', msg, (messages) => node.send(messages), done); });
  }

  async close() {
    for (const node of this.nodes.values()) if (node.listenerCount('close')) await new Promise((done) => { node.emit('close', done); });
    await new Promise((done) => { this.bus.close(done); });
  }
}
