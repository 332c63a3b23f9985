// SPDX-License-Identifier: Apache-2.0
'use strict';

const { THERE, isThere, words } = require('../lib/boards');
const { matches } = require('../lib/protocol');
const { now } = require('../lib/bus');
const { withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-boards', function AsipBoards(config) {
    RED.nodes.createNode(this, config);
    const [key, value] = String(config.label || '').split('=');
    const seen = new Map();
    withBus(RED, this, config, (bus) => {
      const chosen = (board) => matches(config.pattern || '*', board.name)
        && (!key || (Object.hasOwn(board.description.labels, key) && (value === undefined || board.description.labels[key] === value)));
      const count = () => {
        const there = [...bus.boards.all.values()].filter((board) => chosen(board) && isThere(board)).length;
        this.status(bus.ready ? { fill: 'green', shape: 'dot', text: `${there} there` } : { fill: 'yellow', shape: 'ring', text: 'connecting' });
      };
      const told = (board) => {
        count();
        if (!chosen(board) || board.state === 'unknown' || seen.get(board.name) === board.state) return;
        const before = seen.get(board.name);
        seen.set(board.name, board.state);
        if (THERE.includes(before) && isThere(board)) return; // asleep, or at an update
        const event = !isThere(board) ? board.state : before === undefined ? 'joined' : 'returned';
        this.send({ topic: board.name, payload: event, state: board.state, reason: board.reason, text: words(board, now()), labels: { ...board.description.labels } });
      };
      bus.on('board', told);
      bus.on('connected', count);
      bus.on('disconnected', count);
      const first = setImmediate(() => bus.guard('the boards that there are', () => [...bus.boards.all.values()].forEach(told)));
      count();
      return () => {
        clearImmediate(first);
        bus.off('board', told);
        bus.off('connected', count);
        bus.off('disconnected', count);
      };
    });
  });
};
