// SPDX-License-Identifier: Apache-2.0
// Nothing that arrives ends or deafens a flow: the corpora of the C++ fuzz targets, and structured mutations of good messages, on every topic, with
// all nodes of this package behind them.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import test from 'node:test';
import { Flow } from './flow.mjs';

const require = createRequire(import.meta.url);
const { readObject, errorOf } = require('../lib/protocol.js');
const { commandsOf, unitOf, askerOf } = require('../lib/models.js');
const { Standing, requestsFor, textOf } = require('../lib/properties.js');
const RUNS = 4000;

// Numbers that are the same in each run: of a seed.
function diceOf(seed) {
  let state = seed * 2654435761 + 12345;
  const roll = (most) => {
    state = (Math.imul(state ^ (state >>> 15), 2246822519) + 374761393) >>> 0;
    return (state >>> 8) % most;
  };
  return { roll, pick: (list) => list[roll(list.length)] };
}

const odd = () => [null, true, false, 0, -1, 1e300, -1e300, 1e18, 1e30, 'NaN!', 'Infinity!', '', 'x', 'x'.repeat(300), '\0', '\ud800', '__proto__', 'constructor', 'toString', [], {},
  [[]], [null], { '': null }, JSON.parse('{"__proto__":{"is":"online"}}'), { toString: 1, valueOf: 2 }, { is: 'lost' }, ['servo'], JSON.parse('['.repeat(40) + ']'.repeat(40))];
const good = () => ({
  board: 'desk', session: '00673f0000aaaaaa', seq: 7, lease: 60, state: { is: 'online', reason: '', age: 12.5 },
  firmware: { protocol: '0.4', extensions: { B: 1 } }, link: { kind: 'serial' }, agent: { host: 'pi' }, pins: { modes: '6613', analog: { 14: 0 } }, on_demand: { fastest: 20, resting: 0 },
  services: [{ name: 'io', id: 'I', model: 'io@1', title: 'Pins' }, { name: 'distance', id: 'D', model: 'distance@1', count: 2, period: 100 }, { name: 'lights', model: 'lights@3' },
    { name: 'thermo', id: 'W', model: { name: 'thermo', version: 1, events: { e: { name: 'heat', fields: [{ name: 'value', type: 'number', unit: 'C' }] } }, commands: { set: { tag: 'S', answer: 'e', args: [{ name: 'level', names: { off: 0 }, items: [{ name: 'x' }] }] } } } }],
  labels: { room: 'lab' }, names: { services: { distance: 'front' }, pins: { 13: 'status lamp' } },
});
const others = [{ distance: [1, 2], digital: { 2: 1 } }, { id: 'ID', status: 'error', code: 7, error: 'x', reason: 'doubt', clock: 'aa-1', answer: { distance: [4, 2] } },
  { id: 'ID', items: [{ name: 'lights', version: 3, commands: { shine: { args: [{ name: 'lamp' }] } } }] }];

function* places(value) {
  for (const key of Object.keys(value)) {
    yield [value, key];
    if (value[key] && typeof value[key] === 'object') yield* places(value[key]);
  }
}

function mutated(document, dice) {
  const made = structuredClone(document);
  for (let times = dice.pick([1, 1, 1, 2, 4]); times > 0; times -= 1) {
    const all = [...places(made)];
    if (!all.length) break;
    const [where, key] = dice.pick(all);
    const how = dice.roll(4);
    if (how === 0 && !Array.isArray(where)) {
      delete where[key];
      Object.defineProperty(where, dice.pick(['x', '__proto__', '', '1'.repeat(400)]), { value: dice.pick(odd()), enumerable: true, configurable: true, writable: true });
    } else if (how === 1) {
      const [from, key2] = dice.pick([...places(document)]);
      where[key] = structuredClone(from[key2]);
    } else where[key] = dice.pick(odd());
  }
  let text = JSON.stringify(made).replace('"NaN!"', 'NaN').replace('"Infinity!"', 'Infinity');
  if (dice.roll(8) === 0) text = text.replace(/\d+/g, (digits) => dice.pick([digits, '9'.repeat(400), '1e400', '-0', '1'.padEnd(26, '0')]));
  if (dice.roll(16) === 0) text = text.slice(0, dice.roll(text.length));
  return text;
}

const topics = (flow) => ['asip/servicebus/desk/$description', 'asip/servicebus/desk/$state', 'asip/desk/io/out', 'asip/desk/distance/out', flow.bus.topics.reply('desk'), flow.bus.topics.reply('registry'),
  'asip/servicebus/__proto__/$description', 'asip/servicebus/a b/$state', 'asip/servicebus//$state', 'asip/servicebus/desk/$what', 'asip', '', 'asip/servicebus/desk/$properties', 'asip/desk/$values'];

async function started() {
  const flow = new Flow();
  await flow.start([
    { id: 'value', type: 'asip-value', board: 'desk', service: 'distance', initial: true }, { id: 'first', type: 'asip-value', board: 'desk', service: 'distance', element: '0' },
    { id: 'in', type: 'asip-pin-in', board: 'desk', pin: '2', initial: true }, { id: 'analog', type: 'asip-pin-in', board: 'desk', pin: '0', mode: 'analog' },
    { id: 'out', type: 'asip-pin-out', board: 'desk', pin: '13', restore: true }, { id: 'turn', type: 'asip-command', board: 'desk', service: 'servo', command: 'write' },
    { id: 'button', type: 'asip-property-in', board: 'desk', property: 'io/5', initial: true }, { id: 'plug', type: 'asip-property-out', board: 'desk', property: 'io/7' },
    { id: 'boards', type: 'asip-boards', label: 'room=lab' }, { id: 'all', type: 'asip-boards' }]);
  return flow;
}

// What raises, but for what is said of damaged documents.
function oddOf(flow) {
  const odd = [];
  flow.bus.guard = (what, action) => {
    try { action(); } catch (error) { if (!/are damaged/.test(error?.message)) odd.push(`${what}: ${error?.stack}`); }
  };
  return odd;
}

// What nodes and the editor's lists ask of boards.
function use(flow) {
  for (const name of ['desk', '__proto__', 'nowhere']) {
    for (const list of ['boards', 'services', 'commands']) flow.list(list, { board: name, service: 'thermo' });
    for (const service of ['thermo', 'distance', 'lights']) flow.bus.modelOf(name, service);
  }
}

async function works(flow) {
  flow.broker.tell('asip/servicebus/desk/$description', { ...good(), session: 'fffffffffffffff0', seq: 2 ** 52 });
  assert.equal(flow.bus.boards.get('desk').state, 'online');
  flow.sent.length = 0;
  flow.broker.tell('asip/desk/distance/out', { distance: [17, 4] });
  assert.deepEqual(flow.sent.filter(([id]) => id === 'value').map(([, msg]) => msg.payload), [[17, 4]]);
  assert.deepEqual([flow.bus.faults, flow.faults], [0, []]);
  assert.equal({}.is, undefined, 'nothing reached what all objects share');
  await flow.close();
}

function give(flow, topic, text, retain, expiry) {
  const open = [...flow.bus.open.keys(), ...flow.bus.queries.keys()];
  const payload = Buffer.isBuffer(text) ? text : Buffer.from(text.replaceAll('"ID"', JSON.stringify(open.at(-1) ?? 'none')));
  flow.broker.emit('message', topic, payload, { retain, properties: expiry === undefined ? undefined : { messageExpiryInterval: expiry } });
}

test('each input on which a fuzz target ever failed, on each topic', async () => {
  const folder = new URL('../../tests/fuzz/', import.meta.url);
  const files = readdirSync(folder, { recursive: true, withFileTypes: true }).filter((one) => one.isFile() && (one.parentPath ?? one.path).includes('corpus'));
  const flow = await started();
  const strange = oddOf(flow);
  for (const file of files) {
    const payload = readFileSync(`${file.parentPath ?? file.path}/${file.name}`);
    const parts = payload.toString('latin1').match(/\{.*?\}(?=[^,\]}"]|$)/gs) ?? [];
    for (const text of [payload, ...parts.map((part) => Buffer.from(part, 'latin1'))]) for (const [at, topic] of topics(flow).entries()) give(flow, topic, text, at % 3 === 0, [undefined, 0, 7, 4294967295][at % 4]);
    use(flow);
    assert.deepEqual(strange, [], file.name);
  }
  assert.ok(files.length > 200);
  await works(flow);
});

test('mutations of good messages, on each topic', async () => {
  const flow = await started();
  const strange = oddOf(flow);
  for (let seed = 0; seed < RUNS; seed += 1) {
    const dice = diceOf(seed);
    if (seed % 50 === 0) {
      flow.broker.tell('asip/servicebus/desk/$description', { ...good(), seq: seed + 10 });
      flow.input('turn', { payload: [0, 90] });
      await new Promise(setImmediate);
    }
    const text = mutated(dice.pick([good(), good(), ...others]), dice);
    const topic = dice.roll(3) ? topics(flow)[dice.roll(6)] : dice.pick(topics(flow));
    give(flow, topic, text, dice.roll(2) === 0, dice.pick([undefined, 0, 30, 2999999000]));
    use(flow);
    assert.deepEqual(strange, [], `seed ${seed}: ${topic} ${text.slice(0, 300)}`);
  }
  await works(flow);
});

test('properties and values are taken or refused', () => {
  const told = JSON.parse(readFileSync(new URL('../../tests/vectors/properties.json', import.meta.url)));
  let taken = 0;
  for (let seed = 0; seed < RUNS / 5; seed += 1) {
    const dice = diceOf(seed);
    const standing = new Standing();
    standing.takeList(Buffer.from(JSON.stringify(told.list)), 'desk', '');
    for (const [take, document] of [['takeList', told.list], ['takeValues', told.values]]) {
      const text = mutated(document, dice);
      try {
        standing[take](Buffer.from(text), 'desk', '', 1);
        taken += 1;
      } catch (error) {
        assert.match(error.message, /are damaged/, `seed ${seed}: ${text.slice(0, 300)}`);
      }
    }
    for (const one of standing.properties.values()) {
      for (const value of [...[...standing.values.values()].map((each) => each.value ?? null), dice.pick(odd()), { on: true, brightness: dice.pick(odd()), color: dice.pick(odd()) }]) {
        assert.doesNotThrow(() => [textOf(one, value), requestsFor(one, value)], `seed ${seed}`);
      }
    }
  }
  assert.ok(taken > RUNS / 40);
});

test('models are shown or passed over', () => {
  for (let seed = 0; seed < RUNS; seed += 1) {
    let model;
    try { model = JSON.parse(mutated(good().services[3].model, diceOf(seed))); } catch { continue; }
    assert.doesNotThrow(() => [commandsOf(model), unitOf(model, 'heat'), askerOf(model), askerOf(model, 'heat')].map((one) => JSON.stringify(one)), `seed ${seed}`);
  }
});

test('what is no number is refused, and what is deep', () => {
  for (const text of ['{"a":NaN}', '{"a":Infinity}', '{"a":1e400}', '{"a":-1.5E+999}', `{"a":${'9'.repeat(400)}}`, `{"a":${'['.repeat(40)}${']'.repeat(40)}}`, '['.repeat(100000), '{"a":'.repeat(50000)]) {
    assert.equal(readObject(Buffer.from(text)), null, text.slice(0, 40));
  }
  assert.deepEqual(readObject(Buffer.from(`{"a":[1e300,${'9'.repeat(30)}]}`)), { a: [1e300, 1e30] });
  for (const reason of ['constructor', '__proto__', 'toString', { toString: 1 }, 5]) {
    for (const status of ['refused', 'timeout', 'error']) {
      const error = errorOf({ status, reason, error: reason }, 'desk', 'servo');
      assert.doesNotMatch(`${error.kind} ${error.message}`, /function|object/);
    }
  }
});

test('a word that all objects have is no level of a pin', async () => {
  const flow = await started();
  flow.broker.sent.length = 0;
  for (const payload of ['constructor', 'toString', '__proto__', 'valueOf', null, {}, []]) flow.input('out', { payload });
  await new Promise(setImmediate);
  assert.deepEqual(flow.broker.sent.filter(([, request]) => 'write' in request), []);
  await flow.close();
});

test('a message whose reader throws is counted, told once and dropped', async () => {
  const flow = await started();
  const faults = [];
  flow.bus.on('fault', (what) => faults.push(what));
  flow.bus.boards.onState = () => { throw new TypeError('nobody thought of it'); };
  flow.bus.on('board', () => { throw new Error('a listener'); });
  for (let times = 0; times < 5; times += 1) flow.broker.tell('asip/servicebus/desk/$state', 'lost');
  assert.deepEqual([flow.bus.faults, faults.length], [5, 1]);
  flow.broker.tell('asip/servicebus/desk/$description', good());
  assert.deepEqual([flow.bus.faults, faults.length], [6, 2]);
  assert.ok(flow.sent.some(([id, msg]) => id === 'all' && msg.payload === 'joined'), 'others are told');
  await flow.close();
});

test('no two flows share an object', async () => {
  const flow = await started();
  flow.broker.tell('asip/servicebus/desk/$description', good());
  flow.broker.tell('asip/desk/distance/out', { distance: [17, 4] });
  flow.sent.find(([id]) => id === 'value')[1].payload.length = 0;
  const taken = [];
  flow.bus.onValue('desk', 'distance', 1, (value) => { taken.push(structuredClone(value)); value.distance.push(9); });
  await new Promise(setImmediate);
  flow.broker.tell('asip/desk/distance/out', { distance: [18, 5] });
  assert.deepEqual(taken, [{ distance: [17, 4] }, { distance: [18, 5] }]);
  flow.sent.filter(([id]) => id === 'all')[0][1].labels.room = 'changed';
  assert.equal(flow.bus.boards.get('desk').description.labels.room, 'lab');
  await flow.close();
});
