// SPDX-License-Identifier: Apache-2.0
// The vectors that every implementation of the bus reads, the standard models, and the presence of boards.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import test from 'node:test';
import { Broker } from './flow.mjs';

const require = createRequire(import.meta.url);
const protocol = require('../lib/protocol.js');
const { Boards, WORDS } = require('../lib/boards.js');
const { Standing, UNKNOWN, requestsFor, textOf } = require('../lib/properties.js');
const { Bus } = require('../lib/bus.js');
const { addressOf, passwordHint } = require('../lib/bus-address.js');
const { VersionChoice } = require('../lib/mqtt-version.js');
const { Models, askerOf, commandsOf, unitOf } = require('../lib/models.js');
const json = (path) => JSON.parse(readFileSync(new URL(path, import.meta.url)));
const vectors = json('../../tests/vectors/bus.json');

test('names', () => {
  for (const name of vectors.names.board) assert.ok(protocol.validBoard(name), name);
  for (const name of vectors.names.service) assert.ok(protocol.validName(name), name);
  for (const name of vectors.names.neither) assert.ok(!protocol.validName(name), name);
  for (const name of vectors.names.no_board) assert.ok(!protocol.validBoard(name), name);
});

test('topics', () => {
  for (const { root, user, client, board, service, set, ...wanted } of vectors.topics) {
    const topics = protocol.makeTopics(root, user, client);
    for (const [name, topic] of Object.entries(wanted)) assert.equal(topics[name](board, service), topic, name);
  }
});

test('requests', () => {
  for (const { members, reply_to: replyTo, payload, ...options } of vectors.requests) {
    assert.deepEqual(protocol.makeRequest(members, { replyTo, ...options }), payload);
  }
});

test('answers', () => {
  for (const { payload, kind, sent, reason, code } of vectors.answers) {
    const error = protocol.errorOf(payload, 'desk');
    if (!kind) { assert.equal(error, null); continue; }
    assert.deepEqual([error.kind, error.sent, error.reason], [kind, sent, reason]);
    if (code !== undefined) assert.equal(error.code, code);
  }
});

test('sentences of answers', () => {
  const { answers, unreadable, words, maybe } = json('../../tests/vectors/answers.json');
  for (const { answer, text, executed } of [...answers, ...unreadable]) {
    assert.equal(protocol.sentenceOf(answer), text);
    assert.equal(protocol.errorOf(answer, 'desk')?.message, text ? `desk: ${text}` : undefined);
    assert.equal(text.endsWith(maybe), executed === 'maybe');
  }
  for (const [status, reasons] of Object.entries(words)) for (const [reason, text] of Object.entries(reasons)) assert.ok(protocol.sentenceOf({ status, reason }).includes(text), text);
});

test('words of reasons', () => {
  const { states, unknown } = json('../../tests/vectors/reasons.json');
  assert.deepEqual({ '': '', ...WORDS }, states);
  assert.deepEqual(Object.fromEntries(Object.entries(UNKNOWN).map(([name, text]) => [name, `unknown: ${text}`])), unknown);
});

const told = json('../../tests/vectors/properties.json');
const bytes = (document) => Buffer.from(JSON.stringify(document));

function changed(document, [place, value]) {
  const copy = structuredClone(document);
  const path = place.split('/').slice(1).map((one) => one.replaceAll('~1', '/').replaceAll('~0', '~'));
  let at = copy;
  for (const one of path.slice(0, -1)) at = at[one];
  at[path.at(-1)] = value;
  return copy;
}

test('properties', () => {
  const standing = new Standing();
  assert.ok(standing.takeList(bytes(told.list), 'desk', ''));
  assert.deepEqual([...standing.properties.keys()], told.list.properties.map((one) => one.id));
  for (const one of told.list.properties) {
    const { unit = '', min, max, refused = '' } = one;
    const is = standing.properties.get(one.id);
    assert.deepEqual([is.unit, is.min, is.max, is.refused], [unit, min, max, refused]);
  }
  for (const [id, ...derived] of told.left_out) {
    const { service, kind, type, access, name, choices } = standing.properties.get(id);
    assert.deepEqual([service, kind, type, access, name, [...choices]], derived, id);
  }
  for (const { id, value, requests } of told.set) assert.deepEqual(standing.properties.has(id) ? requestsFor(standing.properties.get(id), value) : [], requests, `${id} ${JSON.stringify(value)}`);
  for (const { id, value, text } of told.text) assert.equal(textOf(standing.properties.get(id), value), text);
  assert.ok(standing.takeValues(bytes(told.values), 'desk', '', 100));
  assert.deepEqual([standing.values.get('io/13'), standing.values.get('servo/0/angle')],
    [{ value: true, how: 'set', why: '', since: 83, events: [] }, { value: undefined, how: '', why: 'restart', since: 96.9, events: [] }]);
});

test('damaged properties and values', () => {
  for (const change of told.damaged_lists) assert.throws(() => new Standing().takeList(bytes(changed(told.list, change)), 'desk', ''), TypeError, JSON.stringify(change));
  for (const change of told.damaged_values) assert.throws(() => new Standing().takeValues(bytes(changed(told.values, change)), 'desk', '', 100), TypeError, JSON.stringify(change));
});

test('which properties and values count', () => {
  for (const { about, holder, documents } of told.order) {
    for (const take of ['takeList', 'takeValues']) {
      const standing = new Standing();
      for (const [session, seq, counts] of documents.map((each) => each ?? ['', 0, true])) {
        const document = session ? bytes({ version: 1, board: 'desk', session, seq, properties: [], values: {} }) : Buffer.alloc(0);
        assert.equal(standing[take](document, 'desk', holder, 0), counts, about);
      }
    }
  }
});

test('what is told of buttons', () => {
  for (const { about, documents } of told.acts) {
    const standing = new Standing();
    for (const each of documents) {
      const { session, seq, events = {}, stored, acts = [] } = each ?? {};
      const values = Object.fromEntries(Object.entries(events).map(([id, each]) => [id, { value: true, how: 'reported', age: 0, events: each }]));
      standing.takeValues(each ? bytes({ version: 1, board: 'desk', session, seq, values }) : Buffer.alloc(0), 'desk', '', 0, stored);
      assert.deepEqual(standing.acts, acts, about);
    }
  }
});

test('clock', () => {
  for (const { notes, now, reading, about } of vectors.clock) {
    const clocks = new protocol.Clocks();
    for (const [text, asked, answered] of notes) clocks.note('desk', text, asked, answered);
    assert.equal(clocks.reading('desk', now), reading, about);
  }
});

test('versions of MQTT', () => {
  for (const { about, attempts } of json('../../tests/vectors/mqtt_version.json').brokers) {
    const choice = new VersionChoice();
    for (const { ended, then, same } of attempts) {
      if (ended === 'accepted') choice.accepted();
      else choice.failed(ended, choice.v5);
      assert.deepEqual([choice.v5 ? 5 : 4, choice.suspected], [then, same], `${about}: ${ended}`);
    }
  }
});

test('hints at refused passwords', () => {
  for (const { about, hex, hint } of json('../../tests/vectors/passwords.json').passwords) assert.equal(passwordHint(Buffer.from(hex, 'hex').toString()), hint, about);
  assert.equal(passwordHint(undefined), '');
});

test('models are the standard ones', () => {
  const known = new Models();
  const distance = known.of({ name: 'distance', model: 'distance@1' });
  assert.deepEqual([unitOf(distance, 'distance'), askerOf(distance), askerOf(distance, 'nothing')], ['cm', 'measure', undefined]);
  assert.deepEqual(commandsOf(known.of({ model: 'servo@1' })).find((one) => one.name === 'write').args.map((arg) => [arg.name, arg.min, arg.max, arg.unit]),
    [['servo', 0, 255, undefined], ['angle', 0, 180, 'degrees']]);
  assert.deepEqual(commandsOf(known.of({ model: 'servo@1' })).find((one) => one.name === 'remap').args.map((arg) => arg.name), ['pins'], 'a count is not asked');
});

test('a board that reports nothing is asked, and a registry for a model that is not known', async () => {
  const broker = new Broker();
  const bus = new Bus({ brokers: 'pi' }, () => broker);
  bus.start();
  broker.emit('connect');
  await new Promise((done) => { bus.once('connected', done); });
  broker.tell('asip/servicebus/desk/$description', { board: 'desk', session: '1', seq: 1, lease: 60, state: { is: 'online' }, services: [
    { name: 'distance', model: 'distance@1' }, { name: 'lights', model: 'lights@3' }] });
  const asked = broker.sent.find(([topic]) => topic === 'asip/registry/query')[1];
  assert.deepEqual([asked.find, asked.kind], ['models', ['lights']]);
  broker.tell(asked.reply_to, { id: asked.id, items: [{ name: 'lights', version: 3 }] });
  assert.equal(bus.modelOf('desk', 'lights').version, 3);
  const value = bus.askFor('desk', 'distance');
  const [topic, request] = broker.sent.at(-1);
  assert.deepEqual([topic, request.measure], ['asip/desk/distance/in', []]);
  broker.tell(request.reply_to, { id: request.id, status: 'ok', answer: { distance: [42, 0] } });
  assert.deepEqual(await value, { distance: [42, 0] });
  assert.equal(await bus.askFor('desk', 'lights'), undefined);
  bus.close();
});

test('odd descriptions and odd commands end as errors', async () => {
  const boards = new Boards();
  const say = (seq, more) => boards.onDescription('desk', Buffer.from(JSON.stringify({ board: 'desk', session: '1', seq, lease: 60, ...more })), false, undefined, 1);
  for (const more of [{ services: [null] }, { services: ['io'] }, { services: [{ name: 5 }] }, { services: [], labels: 5 }, { services: [], state: { is: 5 } }]) say(1, more);
  assert.equal(boards.get('desk'), undefined);
  say(1, { services: [{ name: 'servo' }] });
  assert.deepEqual(boards.get('desk').description.labels, {});
  const bus = new Bus({ brokers: 'pi' }, () => new Broker());
  const loop = {};
  loop.loop = loop;
  for (const [board, service, members] of [['a/+', 'servo', {}], ['', 'servo', {}], ['desk', 'se/rvo', {}], [{}, 'servo', {}], ['desk', 'servo', loop], ['desk', 'servo', { write: 1n }]]) {
    await assert.rejects(bus.command(board, service, members), { kind: 'Invalid' });
  }
});

test('a registry is asked once for a model that is not known, and odd models harm nothing', () => {
  const known = new Models();
  const description = { services: [{ name: 'lights', model: 'lights@3' }, { name: 'servo', model: 'servo@1' }, { name: 'own', model: { name: 'own' } }, null, { name: 'bare' }] };
  assert.deepEqual(known.unknown(description), ['lights']);
  assert.deepEqual(known.unknown(description), []);
  known.take([null, 7, { name: 'lights', version: 2 }, { name: 'lights', version: 3, commands: 7, events: [] }]);
  assert.equal(known.of(description.services[0]).version, 3);
  for (const model of [undefined, {}, { commands: 7, events: 'x' }, { commands: { go: null }, events: { d: null } }, { commands: { go: { args: [{}] } } }]) {
    assert.doesNotThrow(() => [commandsOf(model), unitOf(model, 'x'), askerOf(model), askerOf(model, 'x')], JSON.stringify(model));
  }
  known.take(undefined);
});

test('addresses', () => {
  assert.equal(addressOf('pi', false), 'mqtt://pi:1883');
  assert.equal(addressOf('pi', true), 'mqtts://pi:8883');
  assert.equal(addressOf('mqtts://[::1]:99', false), 'mqtts://[::1]:99');
  for (const odd of ['', ' ', 'a b', 'http://pi', '::1', 'pi:0', 'pi:99999', 'pi:x']) assert.throws(() => addressOf(odd, false), /is not HOST/, odd);
  assert.throws(() => new Bus({ brokers: ' , ' }, () => new Broker()), /no broker/);
  assert.throws(() => addressOf('mqtt://ann:secret@pi', false), (error) => !/secret/.test(error.message));
});
