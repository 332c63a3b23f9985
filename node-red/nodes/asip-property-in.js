// SPDX-License-Identifier: Apache-2.0
'use strict';

const { isDeepStrictEqual } = require('node:util');
const { textOf } = require('../lib/properties');
const { withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-property-in', function AsipPropertyIn(config) {
    RED.nodes.createNode(this, config);
    let shown; // what was sent last
    let noReports;
    withBus(RED, this, config, (bus) => {
      const noLooks = bus.standings.watch(config.board, (standing, acts) => {
        const told = standing.properties.get(config.property);
        const value = standing.values.get(config.property);
        if (!told || !value || !value.how) return;
        if (told.read && !noReports) noReports = bus.onValue(config.board, told.service, Number(config.hz) > 0 ? Number(config.hz) : 1, () => {});
        const topic = `${config.board}/${config.property}`;
        for (const [id, word] of acts) if (id === config.property) this.send([null, { topic, payload: word }]);
        if (shown && isDeepStrictEqual(shown.value, value.value)) return;
        const first = shown === undefined;
        shown = value;
        if (first && !config.initial) return;
        this.send({
          topic, payload: structuredClone(value.value), text: textOf(told, value.value), unit: told.unit || undefined,
          how: value.how, retained: first,
        });
      });
      return () => { noLooks(); noReports?.(); };
    });
  });
};
