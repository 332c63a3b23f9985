// SPDX-License-Identifier: Apache-2.0
'use strict';

const { inspect } = require('node:util');
const { requestsFor } = require('../lib/properties');
const { inTurn, outcome, withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-property-out', function AsipPropertyOut(config) {
    RED.nodes.createNode(this, config);
    const next = inTurn(this);
    const bus = withBus(RED, this, config, (own) => own.standings.watch(config.board, () => {}));
    const set = async (requests) => {
      let answer;
      for (const [service, request] of requests) answer = await bus.command(config.board, service, request, { timeout: Number(config.timeout) || 5 });
      return answer;
    };

    this.on('input', (msg, send, done) => {
      if (!bus) return done(new Error('no bus is chosen'));
      const standing = bus.standings.get(config.board);
      if (!standing?.isListed) return done(new Error(`${config.board}: its agent has told no properties; one of an older version never does: update asip-agent there`));
      const told = standing.properties.get(config.property);
      if (!told) return done(new Error(`${config.board} has no property ${config.property}; it has ${[...standing.properties.keys()].slice(0, 12).join(', ') || 'none'}`));
      if (told.refused) return done(new Error(`${config.board}/${config.property}: ${told.refused}`));
      const requests = requestsFor(told, structuredClone(valueOf(told, msg.payload)));
      if (!requests.length) {
        const why = told.access === 'read' ? 'it cannot be set' : `payload ${inspect(msg.payload, { depth: 1 }).slice(0, 100)} is no value of it`;
        return done(new Error(`${config.board}/${config.property}: ${why}`));
      }
      const ends = outcome(this, bus, config.board, msg, send, done);
      ends.began();
      next(() => set(requests)).then(ends.executed, ends.failed).catch((error) => this.error(error.message, {}));
      return undefined;
    });
  });
};

// What flows send for on and off, and numbers as text.
function valueOf(told, payload) {
  const isTwo = told.kind === 'switch' || told.kind === 'light';
  const words = { __proto__: null, true: true, false: false, 1: true, 0: false, on: true, off: false };
  if (isTwo && ['boolean', 'number', 'string'].includes(typeof payload)) {
    const on = words[String(payload).toLowerCase()];
    return on === undefined || told.kind === 'switch' ? on : { on };
  }
  if (told.kind === 'number' && typeof payload === 'string' && payload.trim() !== '') return Number(payload);
  return payload === undefined ? null : payload;
}
