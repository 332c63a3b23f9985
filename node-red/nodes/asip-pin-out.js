// SPDX-License-Identifier: Apache-2.0
'use strict';

const { inspect } = require('node:util');
const { inTurn, outcome, whenThere, withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-pin-out', function AsipPinOut(config) {
    RED.nodes.createNode(this, config);
    const pin = Number(config.pin);
    const pwm = config.mode === 'pwm';
    let wanted; // what the last message set
    const next = inTurn(this);
    const bus = withBus(RED, this, config, (own) => whenThere(own, config.board, () => {
      const again = wanted;
      next(() => setMode(own).then(() => (again === undefined || !config.restore ? undefined : write(own, again))))
        .catch((error) => { if (error.kind !== 'Closed') this.error(error.message, {}); });
    }));
    const setMode = (own) => own.command(config.board, 'io', { mode: [pin, pwm ? 'pwm' : 'output'] });
    const write = (own, value) => own.command(config.board, 'io', pwm ? { pwm: [pin, value] } : { write: [pin, value] });

    this.on('input', (msg, send, done) => {
      if (!bus) return done(new Error('no bus is chosen'));
      const value = valueOf(msg.payload, pwm, config.invert);
      if (value === null) return done(new Error(`payload ${inspect(msg.payload, { depth: 1 }).slice(0, 100)} is no ${pwm ? 'number from 0 to 255' : 'level: true, false, 1, 0, "on", "off"'}`));
      const ends = outcome(this, bus, config.board, msg, send, done);
      wanted = value;
      ends.began();
      next(() => write(bus, value)).then(ends.executed, ends.failed).catch((error) => this.error(error.message, {}));
      return undefined;
    });
  });
};

function valueOf(payload, pwm, invert) {
  if (!['boolean', 'number', 'string'].includes(typeof payload) || payload === '') return null;
  if (pwm) {
    const duty = typeof payload === 'boolean' ? NaN : Number(payload);
    return Number.isInteger(duty) && duty >= 0 && duty <= 255 ? (invert ? 255 - duty : duty) : null;
  }
  const words = { __proto__: null, true: 1, false: 0, 1: 1, 0: 0, on: 1, off: 0, high: 1, low: 0 };
  const level = words[String(payload).toLowerCase()];
  return level === undefined ? null : level ^ (invert ? 1 : 0);
}
