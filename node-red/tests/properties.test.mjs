// SPDX-License-Identifier: Apache-2.0
// The nodes of properties: what a board's agent tells is shown, and what a flow sets becomes commands.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { Flow } from './flow.mjs';

const { list } = JSON.parse(readFileSync(new URL('../../tests/vectors/properties.json', import.meta.url)));
const soon = () => new Promise(setImmediate);

async function flowOf(...configs) {
  const flow = new Flow();
  await flow.start(configs);
  flow.broker.tell('asip/servicebus/desk/$description', { board: 'desk', session: list.session, seq: 1, lease: 60, state: { is: 'online' }, on_demand: {}, services: [{ name: 'io', model: 'io@1' }] });
  flow.stands = (seq, values, retain) => flow.broker.tell('asip/desk/$values', { version: 1, board: 'desk', session: list.session, seq, values }, retain);
  flow.answers = async (answer = { status: 'ok', proof: 'fence' }) => {
    for (const [, request] of flow.broker.sent.splice(0)) if (request.id) flow.broker.tell(request.reply_to, { id: request.id, ...answer });
    await soon();
  };
  return flow;
}

test('a property that changes is told once, with its words, and what is not known is not', async () => {
  const flow = await flowOf({ id: 'door', type: 'asip-property-in', board: 'desk', property: 'io/2', initial: true });
  flow.stands(8, { 'io/2': { unknown: 'never', age: 1 } });
  flow.broker.tell('asip/servicebus/desk/$properties', list);
  assert.deepEqual(flow.sent, []);
  for (const [seq, value] of [[9, false], [10, false], [11, true], [10, false], [12, true]]) flow.stands(seq, { 'io/2': { value, how: 'reported', age: 0 } });
  assert.deepEqual(flow.sent.map(([, msg]) => [msg.topic, msg.payload, msg.text, msg.retained]), [['desk/io/2', false, 'closed', true], ['desk/io/2', true, 'open', false]]);
  const demands = flow.broker.sent.filter(([topic]) => topic.includes('/$demand/'));
  assert.ok(demands.length > 0 && demands.every(([, demand]) => demand.services.io === 1), 'nothing but a demand was sent');
  assert.equal(flow.broker.sent.length, demands.length);
  await flow.close();
});

test('what is done with a button is told once at the second output, and no echo is a value', async () => {
  const flow = await flowOf({ id: 'button', type: 'asip-property-in', board: 'desk', property: 'io/5', initial: true }, { id: 'far', type: 'asip-property-in', board: 'desk', property: 'distance/0' });
  flow.broker.tell('asip/servicebus/desk/$properties', list);
  const stands = (seq, value, events, retain) => flow.stands(seq, { 'io/5': { value, how: 'reported', age: 0, events }, 'io/4': { value, how: 'reported', age: 0 } }, retain);
  stands(8, false, [[1, 'press'], [2, 'release']], true);
  stands(9, true, [[2, 'release'], [3, 'press']]);
  stands(10, true, [[3, 'press'], [4, 'hold']]);
  stands(11, false, [[4, 'hold'], [5, 'release']], true);
  stands(12, true, [[6, 'press'], [7, 'double'], [8, 'triple']]);
  assert.deepEqual(flow.sent.map(([id, { payload }, output]) => [id, payload, output]), [['button', false, 0], ['button', 'press', 1], ['button', true, 0], ['button', 'hold', 1],
    ['button', false, 0], ['button', 'press', 1], ['button', 'double', 1], ['button', true, 0]]);
  flow.sent.length = 0;
  for (const [at, value] of [42, null, 7].entries()) flow.stands(20 + at, { 'distance/0': { value, how: 'reported', age: 0 } });
  assert.deepEqual(flow.sent.map(([, { payload, text }]) => [payload, text]), [[null, 'none'], [7, '7 cm']], 'without the present value at first');
  await flow.close();
});

test('a property is set by the commands that its board takes', async () => {
  const flow = await flowOf({ id: 'lamp', type: 'asip-property-out', board: 'desk', property: 'io/13' }, { id: 'servo', type: 'asip-property-out', board: 'desk', property: 'servo/0/angle' },
    { id: 'plug', type: 'asip-property-out', board: 'desk', property: 'io/7' }, { id: 'far', type: 'asip-property-out', board: 'desk', property: 'distance/0' }, { id: 'none', type: 'asip-property-out', board: 'desk', property: 'io/99' });
  assert.match((await flow.input('lamp', { payload: true })).message, /update asip-agent/);
  flow.broker.tell('asip/servicebus/desk/$properties', list);
  const done = flow.input('lamp', { payload: 'ON' });
  await soon();
  const commands = [];
  while (flow.broker.sent.length) {
    commands.push(...flow.broker.sent.map(([topic, { mode, write }]) => [topic, mode ?? write]));
    await flow.answers();
  }
  assert.equal(await done, undefined);
  assert.deepEqual(commands, [['asip/desk/io/in', [13, 3]], ['asip/desk/io/in', [13, 1]]]);
  for (const [id, payload, fault] of [['lamp', 'up', /no value of it/], ['servo', 181, /no value of it/], ['servo', {}, /no value of it/], ['far', 1, /cannot be set/], ['plug', true, /a command made pin 7 input-pullup, and plug needs an output: asipctl pin desk 7 output/], ['none', 1, /no property io\/99; it has/]]) {
    assert.match((await flow.input(id, { payload })).message, fault);
  }
  assert.deepEqual(flow.broker.sent, []);
  const turned = flow.input('servo', { payload: '90' });
  await soon();
  assert.deepEqual(flow.broker.sent.at(-1)[1].write, [0, 90]);
  await flow.answers({ status: 'timeout', reason: 'doubt' });
  assert.match((await turned).message, /may or may not/);
  assert.deepEqual(flow.faults, []);
  await flow.close();
});

test('a node that reads a pin changes no output, and finds an analog channel', async () => {
  const flow = new Flow();
  await flow.start([{ id: 'lamp', type: 'asip-pin-in', board: 'desk', pin: '3' }, { id: 'dimmed', type: 'asip-pin-in', board: 'desk', pin: '4' }, { id: 'button', type: 'asip-pin-in', board: 'desk', pin: '2' },
    { id: 'knob', type: 'asip-pin-in', board: 'desk', pin: '0', mode: 'analog' }, { id: 'other', type: 'asip-pin-in', board: 'desk', pin: '1', mode: 'analog' },
    { id: 'none', type: 'asip-pin-in', board: 'desk', pin: '9', mode: 'analog' }]);
  flow.broker.tell('asip/servicebus/desk/$description', { board: 'desk', session: 's', seq: 1, lease: 60, state: { is: 'online' }, services: [{ name: 'io', model: 'io@1' }],
    pins: { modes: '66035114', analog: { 6: 1, 7: 0 } } });
  assert.deepEqual(flow.broker.sent.map(([, { mode }]) => mode), [[2, 'input-pullup'], [6, 'analog']]);
  assert.deepEqual(flow.errors.map(([id]) => id), ['lamp', 'dimmed', 'none']);
  await flow.close();
});

test('damaged documents are counted, and the next one works; the editor lists what there is', async () => {
  const flow = await flowOf({ id: 'door', type: 'asip-property-in', board: 'desk', property: 'io/2', initial: true });
  for (const topic of ['asip/servicebus/desk/$properties', 'asip/desk/$values']) {
    for (const odd of ['[[[', '7', { version: 2 }, { ...list, board: 'other' }, { ...list, properties: 7, values: [] }, { ...list, values: { x: null }, properties: [null] }]) flow.broker.tell(topic, odd);
  }
  assert.equal(flow.bus.faults, 12);
  flow.broker.tell('asip/servicebus/desk/$properties', list);
  flow.stands(9, { 'io/2': { value: true, how: 'reported', age: 0 }, __proto__: { value: 1, how: 'set' } });
  assert.deepEqual(flow.sent.map(([, msg]) => msg.payload), [true]);
  assert.match(flow.list('properties', { board: 'desk' }), /"id":"servo\/0\/angle"/);
  flow.broker.tell('asip/servicebus/desk/$properties', '');
  assert.equal(flow.list('properties', { board: 'desk' }), '[]');
  await flow.close();
});
