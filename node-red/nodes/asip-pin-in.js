// SPDX-License-Identifier: Apache-2.0
'use strict';

const { whenThere, withBus } = require('../lib/node');

const MODES = { __proto__: null, 3: 'output', 4: 'analog', 5: 'pwm' };

module.exports = (RED) => {
  RED.nodes.registerType('asip-pin-in', function AsipPinIn(config) {
    RED.nodes.createNode(this, config);
    const pin = Number(config.pin);
    const mode = config.mode || 'input-pullup';
    const event = mode === 'analog' ? 'analog' : 'digital';
    let level;
    withBus(RED, this, config, (bus) => {
      const noValues = bus.onValue(config.board, 'io', 10, (payload) => {
        const value = payload[event]?.[pin];
        if (typeof value !== 'number' || value === level) return;
        const first = level === undefined;
        level = value;
        if (first && !config.initial) return;
        const shown = event === 'digital' ? Boolean(value) !== Boolean(config.invert) : value;
        this.send({ topic: `${config.board}/pin/${pin}`, payload: shown, retained: first });
      });
      // The mode is set again each time the board comes back: a board that restarted has forgotten it. An output stays one.
      const noMode = whenThere(bus, config.board, () => {
        const pins = bus.boards.get(config.board).description.pins ?? {};
        const number = event === 'analog' ? Number(Object.entries(pins.analog ?? {}).find(([, channel]) => channel === pin)?.[0] ?? NaN) : pin;
        const present = MODES[pins.modes?.[number]];
        if (Number.isNaN(number)) this.error(`${config.board} has no analog channel ${pin}`, {});
        else if (present === 'output' || present === 'pwm') this.warn(`pin ${number} of ${config.board} is an output, and stays one: use asip property in`);
        else if (event !== 'analog' || present !== mode) bus.command(config.board, 'io', { mode: [number, mode] }).catch((error) => this.error(error.message, {}));
      });
      return () => { noValues(); noMode(); };
    });
  });
};
