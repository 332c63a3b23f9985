// SPDX-License-Identifier: Apache-2.0
'use strict';

const { unitOf } = require('../lib/models');
const { whenThere, withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-value', function AsipValue(config) {
    RED.nodes.createNode(this, config);
    const hz = Number(config.hz) > 0 ? Number(config.hz) : 10;
    const element = config.element === '' || config.element === undefined ? null : config.element;
    withBus(RED, this, config, (bus) => {
      let heard = false; // a value, since the flow started or the board came back
      const take = (payload, retained) => {
        if (retained && !config.initial) return;
        const event = config.event || Object.keys(payload)[0];
        if (event === undefined || !Object.hasOwn(payload, event)) return;
        const value = element === null ? payload[event] : payload[event]?.[element];
        if (value === undefined) return;
        heard = true;
        const unit = unitOf(bus.modelOf(config.board, config.service), event);
        this.send({ topic: `${config.board}/${config.service}`, payload: value, event, unit, retained });
      };
      const noValues = bus.onValue(config.board, config.service, hz, take);
      let first;
      // First the present value: a board that reports nothing by itself is asked.
      const noFirst = config.initial ? whenThere(bus, config.board, () => {
        heard = false;
        clearTimeout(first);
        first = setTimeout(() => {
          if (heard) return;
          bus.askFor(config.board, config.service, config.event).then((answer) => {
            if (answer && typeof answer === 'object' && !heard) take(answer, true);
          }).catch((error) => this.warn(`the present value: ${error.message}`));
        }, 300);
      }) : () => {};
      return () => { clearTimeout(first); noFirst(); noValues(); };
    });
  });
};
