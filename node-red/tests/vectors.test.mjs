// SPDX-License-Identifier: Apache-2.0
// The vectors that every implementation of the bus reads, the units of the standard models, and the presence of boards.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import test from 'node:test';

const require = createRequire(import.meta.url);
const protocol = require('../lib/protocol.js');
const { Boards, words } = require('../lib/boards.js');
const { addressOf } = require('../lib/bus-address.js');
const json = (path) => JSON.parse(readFileSync(new URL(path, import.meta.url)));
const vectors = json('../../tests/vectors/bus.json');

test('names', () => {
  for (const name of vectors.names.board) assert.ok(protocol.validBoard(name), name);
  for (const name of vectors.names.service) assert.ok(protocol.validName(name), name);
  for (const name of vectors.names.neither) assert.ok(!protocol.validName(name), name);
  for (const name of vectors.names.no_board) assert.ok(!protocol.validBoard(name), name);
});

test('topics', () => {
  for (const { root, user, client, board, service, ...wanted } of vectors.topics) {
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

test('clock', () => {
  for (const { notes, now, reading, about } of vectors.clock) {
    const clocks = new protocol.Clocks();
    for (const [text, asked, answered] of notes) clocks.note('desk', text, asked, answered);
    assert.equal(clocks.reading('desk', now), reading, about);
  }
});

test('units are those of the standard models', () => {
  const units = {};
  for (const file of readdirSync(new URL('../../services/', import.meta.url)).filter((name) => name !== 'schema.json')) {
    const model = json(`../../services/${file}`);
    for (const event of Object.values(model.events || {})) {
      if (event.fields?.[0]?.unit) (units[model.name] ||= {})[event.name] = event.fields[0].unit;
    }
  }
  assert.deepEqual(json('../lib/units.json'), units);
});

test('a lost board stays lost over many renewals, and damaged documents change nothing', () => {
  const boards = new Boards();
  const say = (seq, state, now) => boards.onDescription('desk', Buffer.from(JSON.stringify({ board: 'desk', session: '1', seq, lease: 60, services: [], state })), false, undefined, now);
  say(1, { is: 'online' }, 0);
  say(2, { is: 'lost', reason: 'unplugged' }, 5);
  for (let turn = 0; turn < 10; turn += 1) say(3 + turn, { is: 'lost', reason: 'unplugged' }, 25 + 20 * turn);
  assert.equal(words(boards.get('desk')), 'lost: cable unplugged');
  for (const text of ['', '{', '[]', '{"board":"x"}', '{"board":"desk","services":[],"seq":"y"}']) assert.equal(boards.onDescription('desk', Buffer.from(text), false, undefined, 9), undefined);
  say(20, { is: 'online' }, 300);
  assert.deepEqual(boards.expire(361).map((board) => [board.state, board.reason]), [['lost', 'expired']]);
  assert.equal(boards.onState('lamp', Buffer.from('online\r\n'), 0).state, 'online');
});

test('addresses', () => {
  assert.equal(addressOf('pi', false), 'mqtt://pi:1883');
  assert.equal(addressOf('pi', true), 'mqtts://pi:8883');
  assert.equal(addressOf('mqtts://[::1]:99', false), 'mqtts://[::1]:99');
  assert.throws(() => addressOf('mqtt://ann:secret@pi', false), (error) => !/secret/.test(error.message));
});
