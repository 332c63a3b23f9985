// SPDX-License-Identifier: Apache-2.0
// The nodes say of a board what the C++ programs say after the same messages: tests/vectors/presence.json.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import test from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import { Broker, Flow } from './flow.mjs';

const require = createRequire(import.meta.url);
const { Boards, words } = require('../lib/boards.js');
const vectors = JSON.parse(readFileSync(process.env.ASIP_PRESENCE_VECTORS ?? new URL('../../tests/vectors/presence.json', import.meta.url)));

function take(boards, step, name) {
  if (step.heard === true) boards.connected(step.at);
  else if (step.heard === false) boards.disconnected();
  else if ('state' in step) boards.onState(name, Buffer.from(step.state), Boolean(step.kept), step.expiry, step.at);
  else if ('say' in step || 'text' in step) {
    boards.onDescription(name, Buffer.from(step.text ?? JSON.stringify({ board: name, services: [], ...step.say })), Boolean(step.kept), step.expiry, step.at);
  }
}

test('what is shown after each message is what the file says', () => {
  let steps = 0;
  for (const { about, board: name = 'desk', steps: history } of vectors.histories) {
    const boards = new Boards();
    for (const step of history) {
      take(boards, step, name);
      boards.expire(step.at + 1e-6); // a sum of seconds may be a little more than it is
      const board = boards.get(name);
      const told = board ? [board.effective, board.reason, board.since === -Infinity ? null : step.at - board.since] : null;
      const isKnown = told && step.then && told[2] !== null && step.then[2] !== null;
      const alike = isKnown ? told[0] === step.then[0] && told[1] === step.then[1] && Math.abs(told[2] - step.then[2]) < 0.001 : isDeepStrictEqual(told, step.then);
      assert.ok(alike, `${about}: ${JSON.stringify(step)} is ${JSON.stringify(told)}`);
      steps += 1;
    }
  }
  assert.ok(steps > 1000);
});

test('a word that the broker kept alone is not shown as lost, and times are told', () => {
  const boards = new Boards();
  boards.onState('desk', Buffer.from('online'), true, undefined, 0);
  assert.equal(boards.get('desk').state, 'unknown');
  boards.onDescription('desk', Buffer.from(JSON.stringify({ board: 'desk', session: 's', seq: 1, services: [], state: { is: 'lost', reason: 'unplugged', age: 10 } })), true, 30, 0);
  assert.deepEqual([words(boards.get('desk'), 120), words(boards.get('desk'))], ['lost 2 min ago: cable unplugged', 'lost: cable unplugged']);
});

test('a minute without the broker makes no board lost', async () => {
  const flow = new Flow(() => {
    const again = flow.broker.listenerCount('message') > 0;
    flow.broker = new Broker();
    if (again) setImmediate(() => flow.broker.emit('connect'));
    return flow.broker;
  });
  await flow.start([{ id: 'boards', type: 'asip-boards' }]);
  flow.broker.tell('asip/servicebus/desk/$description', { board: 'desk', session: 's', seq: 1, lease: 1, services: [], state: { is: 'online' } });
  const connected = new Promise((done) => { flow.bus.once('connected', done); });
  flow.broker.emit('close');
  flow.bus.boards.get('desk').deadline -= 3600;
  flow.bus.tick();
  assert.equal(flow.bus.boards.get('desk').state, 'online');
  await connected;
  flow.bus.tick();
  assert.equal(flow.bus.boards.get('desk').state, 'online', 'it has its grace');
  assert.deepEqual(flow.sent.map(([, msg]) => msg.payload), ['joined']);
  await flow.close();
});
