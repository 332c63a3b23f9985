// SPDX-License-Identifier: Apache-2.0
'use strict';

const { withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-value', function AsipValue(config) {
    RED.nodes.createNode(this, config);
    const hz = Number(config.hz) > 0 ? Number(config.hz) : 10;
    const element = config.element === '' || config.element === undefined ? null : config.element;
    withBus(RED, this, config, (bus) => bus.onValue(config.board, config.service, hz, (payload, retained) => {
      if (retained && !config.initial) return;
      const event = config.event || Object.keys(payload)[0];
      if (!(event in payload)) return;
      const value = element === null ? payload[event] : payload[event]?.[element];
      if (value === undefined) return;
      this.send({ topic: `${config.board}/${config.service}`, payload: value, event, unit: unitOf(bus, config, event), retained });
    }));
  });

  // The unit of the event where the board carries its model; standard models stand in no description.
  function unitOf(bus, config, event) {
    const service = bus.boards.get(config.board)?.description.services.find((one) => one.name === config.service);
    const events = service && typeof service.model === 'object' ? Object.values(service.model.events || {}) : [];
    return events.find((one) => one.name === event)?.fields?.[0]?.unit || UNITS[`${service?.model}`.split('@')[0]]?.[event];
  }
};

const UNITS = require('../lib/units.json');
