// SPDX-License-Identifier: Apache-2.0
// Events late and in any order: each event of a flow or of a broker at each moment of a connection. Nothing ends Node-RED, each message of a flow is
// done once, and the next connection serves.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { Broker, Flow } from './flow.mjs';

const description = { board: 'desk', session: 's', seq: 1, lease: 60, state: { is: 'online' }, services: [{ name: 'servo', model: 'servo@1' }, { name: 'distance', model: 'distance@1' }] };
const { list } = JSON.parse(readFileSync(new URL('../../tests/vectors/properties.json', import.meta.url)));
const told = { ...list, session: 's' };
const values = (seq, number) => ({ version: 1, board: 'desk', session: 's', seq, values: { 'io/5': { value: true, how: 'reported', age: 0, events: [[number, 'press']] } } });
const soon = () => new Promise(setImmediate);

async function until(condition, what, seconds = 6) {
  const end = Date.now() + seconds * 1000;
  while (!condition()) {
    assert.ok(Date.now() < end, what);
    await new Promise((done) => { setTimeout(done, 5); });
  }
}

// A broker that does what a test says; `ended` when the program gave it up.
class Hand extends Broker {
  ended = false;

  mute = false; // frozen: it says nothing more, and its connection does not even end

  closed = false;

  publish(topic, text) { this.sent.push([topic, topic.includes('/$self/') ? text : JSON.parse(text)]); }

  hello(rig) { this.tell(rig.bus.topics.own(), 'hello'); }

  answerAll() { for (const [, request] of [...this.sent]) if (request.reply_to) this.tell(request.reply_to, { id: request.id, status: 'ok', proof: 'fence' }); }

  close() {
    if (this.closed) return;
    this.closed = true;
    this.emit('close');
  }

  end(force, _options, done) {
    this.ended = true;
    if (this.mute && !force) return;
    setImmediate(() => { this.close(); done?.(); });
  }
}

async function rigAt(moment) {
  const rig = new Flow(() => { rig.brokers.push(new Hand()); return rig.brokers.at(-1); });
  Object.assign(rig, { brokers: [], inputs: [], ends: [] });
  rig.ask = (id, msg) => {
    const input = { done: 0 };
    rig.inputs.push(input);
    const node = rig.nodes.get(id);
    node.emit('input', msg, (messages) => node.send(messages), () => { input.done += 1; });
  };
  rig.bus.start();
  rig.serve = () => {
    rig.brokers.at(-1).emit('connect');
    rig.brokers.at(-1).hello(rig);
    rig.brokers.at(-1).tell('asip/servicebus/desk/$description', description);
    rig.brokers.at(-1).tell('asip/servicebus/desk/$properties', told, true);
  };
  for (const [id, type, more] of [['turn', 'asip-command', { service: 'servo', command: 'write', timeout: 0.2 }], ['out', 'asip-pin-out', { pin: '13', restore: true }],
    ['in', 'asip-pin-in', { pin: '2' }], ['value', 'asip-value', { service: 'distance', initial: true }], ['boards', 'asip-boards', {}],
    ['button', 'asip-property-in', { property: 'io/5' }], ['plug', 'asip-property-out', { property: 'io/13', timeout: 0.2 }]]) rig.add({ id, type, board: 'desk', ...more });
  await MOMENTS[moment](rig);
  return rig;
}

const MOMENTS = {
  connecting: () => {},
  accepted: (rig) => rig.brokers[0].emit('connect'),
  serving: (rig) => rig.serve(),
  asked: async (rig) => { rig.serve(); rig.ask('turn', { payload: [0, 90] }); await soon(); },
  frozen: (rig) => { rig.serve(); rig.brokers[0].mute = true; },
  lost: (rig) => { rig.serve(); rig.brokers[0].close(); },
  refused: (rig) => { rig.brokers[0].emit('error', Object.assign(new Error('refused'), { code: 'ECONNREFUSED' })); },
  closed: async (rig) => { rig.serve(); await closeAll(rig); },
};

const closeAll = async (rig) => {
  let times = 0;
  for (const node of rig.nodes.values()) await new Promise((done) => { node.emit('close', done); });
  rig.nodes.clear();
  await new Promise((done) => { rig.bus.close(() => { times += 1; done(); }); });
  await soon();
  assert.equal(times, 1);
};
const first = (what) => (rig) => what(rig.brokers[0], rig);

const EVENTS = {
  'the flow ends': closeAll,
  'the flow ends twice': async (rig) => { await closeAll(rig); await closeAll(rig); },
  'a node ends and begins again': async (rig) => {
    await new Promise((done) => { rig.nodes.get('turn')?.emit('close', done) ?? done(); });
    if (rig.nodes.has('turn')) rig.add({ id: 'turn', type: 'asip-command', board: 'desk', service: 'servo', command: 'write', timeout: 0.2 });
  },
  'messages': (rig) => { for (const id of ['turn', 'out', 'plug']) if (rig.nodes.has(id)) for (const payload of [[0, 1], true, 'on', 5n, null, { toString: 1 }]) rig.ask(id, { payload }); },
  'messages, then the flow ends': async (rig) => { for (let at = 0; at < 5; at += 1) if (rig.nodes.has('turn')) rig.ask('turn', { payload: [0, at] }); await closeAll(rig); },
  'a node whose outputs throw': (rig) => {
    const node = rig.nodes.get('turn');
    if (!node) return;
    rig.ends.push(() => { delete node.send; });
    node.send = () => { throw new Error('a flow'); };
    const input = { done: 0 };
    rig.inputs.push(input);
    node.emit('input', { payload: [0, 1] }, node.send, () => { input.done += 1; });
  },
  'a listener that throws': (rig) => { for (const name of ['board', 'connected', 'disconnected']) rig.bus.on(name, () => { throw new Error(name); }); },
  'late CONNACK': first((broker) => broker.emit('connect')),
  'late hello': first((broker, rig) => broker.hello(rig)),
  'late close': first((broker) => { broker.close(); broker.emit('close'); }),
  'late error': first((broker) => broker.emit('error', new Error('late'))),
  'late error with a code': first((broker) => broker.emit('error', Object.assign(new Error('late'), { code: 132 }))),
  'late value': first((broker) => broker.tell('asip/desk/distance/out', { distance: [1, 2] })),
  'late description': first((broker) => broker.tell('asip/servicebus/desk/$description', { ...description, seq: 2 })),
  'late list': first((broker) => broker.tell('asip/servicebus/desk/$properties', told, true)),
  'late values': first((broker) => { for (const seq of [7, 8, 6]) broker.tell('asip/desk/$values', values(seq, seq), seq === 7); }),
  'cleared list and values': first((broker) => { for (const topic of ['asip/servicebus/desk/$properties', 'asip/desk/$values']) broker.tell(topic, ''); }),
  'late answers': first((broker) => broker.answerAll()),
  'late answers twice': first((broker) => { broker.answerAll(); broker.answerAll(); }),
};

// The connection that there is, or the next one, serves each node.
async function serves(rig) {
  if (rig.bus.closed) return;
  if (rig.brokers.at(-1).mute) rig.brokers.at(-1).close();
  await until(() => rig.bus.link, 'the next connection');
  if (!rig.bus.ready) rig.serve();
  else rig.brokers.at(-1).tell('asip/servicebus/desk/$description', { ...description, seq: 9 });
  await until(() => rig.bus.ready, 'a bus that serves');
  rig.ends.forEach((end) => end());
  rig.ask('turn', { payload: [0, 17] });
  await until(() => { rig.brokers.at(-1).answerAll(); return rig.brokers.at(-1).sent.some(([, request]) => request.write?.[1] === 17); }, 'a command that is sent');
  rig.sent.length = 0;
  rig.brokers.at(-1).tell('asip/desk/distance/out', { distance: [5, 6] });
  assert.ok(rig.sent.some(([id, msg]) => id === 'value' && msg.payload[0] === 5), 'a value that comes');
  rig.brokers.at(-1).tell('asip/servicebus/desk/$properties', { ...told, seq: 1e6 });
  rig.brokers.at(-1).tell('asip/desk/$values', values(1e6, 1e6));
  assert.ok(rig.sent.some(([id, msg, output]) => id === 'button' && msg.payload === 'press' && output === 1), 'a button that is pressed');
  rig.ask('plug', { payload: true });
  await until(() => { rig.brokers.at(-1).answerAll(); return rig.brokers.at(-1).sent.some(([, request]) => request.write?.[0] === 13); }, 'a property that is set');
}

const strange = [];
process.on('uncaughtException', (error) => strange.push(error));
process.on('unhandledRejection', (error) => strange.push(error));

for (const moment of Object.keys(MOMENTS)) {
  test(`each event: ${moment}`, async () => {
    await Promise.all(Object.entries(EVENTS).map(async ([name, event]) => {
      const rig = await rigAt(moment);
      await event(rig);
      await soon();
      await serves(rig);
      const about = `${moment}, ${name}`;
      const sent = rig.brokers.reduce((sum, broker) => sum + broker.sent.length, 0);
      if (!rig.bus.closed) {
        rig.brokers.at(-1).answerAll();
        await closeAll(rig);
      } else {
        await soon();
        assert.equal(rig.brokers.reduce((sum, broker) => sum + broker.sent.length, 0), sent, `${about}: it sends behind its end`);
      }
      await until(() => rig.inputs.every((input) => input.done > 0), `${about}: a message that is never done`);
      assert.ok(rig.inputs.every((input) => input.done === 1), `${about}: a message that is done twice`);
      assert.ok(rig.brokers.every((broker) => broker.closed || broker.ended), `${about}: a connection that is left`);
      assert.deepEqual(strange.splice(0).map((error) => `${about}: ${error.stack}`), []);
    }));
  });
}

test('a flow that changes its message does not change what waits', async () => {
  const rig = await rigAt('serving');
  const payload = [0, 1];
  rig.ask('turn', { payload: [0, 0] });
  rig.ask('turn', { payload });
  payload[1] = 99;
  await until(() => { rig.brokers[0].answerAll(); return rig.inputs.every((input) => input.done === 1); }, 'both');
  assert.deepEqual(rig.brokers[0].sent.filter(([, request]) => request.write).map(([, request]) => request.write), [[0, 0], [0, 1]]);
  await closeAll(rig);
});
