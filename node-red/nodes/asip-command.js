// SPDX-License-Identifier: Apache-2.0
'use strict';

const { inTurn, outcome, withBus } = require('../lib/node');

module.exports = (RED) => {
  RED.nodes.registerType('asip-command', function AsipCommand(config) {
    RED.nodes.createNode(this, config);
    const bus = withBus(RED, this, config);
    const next = inTurn(this);
    this.on('input', (msg, send, done) => {
      if (!bus) return done(new Error('no bus is chosen'));
      let args;
      try {
        args = config.args ? RED.util.evaluateNodeProperty(config.args, 'json', this, msg) : msg.payload;
      } catch (error) {
        return done(new Error(`the arguments are no JSON: ${error.message}`));
      }
      try { // as it is now: flows change what they send
        args = JSON.parse(JSON.stringify(args ?? null));
      } catch (error) {
        return done(new Error(`the arguments cannot be written as JSON: ${error.message}`));
      }
      const board = msg.board || config.board;
      const service = msg.service || config.service;
      const command = msg.command || config.command;
      if (!board || !service || !command) return done(new Error('board, service and command: each stands in the node or in the message'));
      const ends = outcome(this, bus, board, msg, send, done);
      const hold = Number(config.hold) > 0 ? Number(config.hold) : undefined;
      ends.began();
      next(() => bus.command(board, service, { [command]: args }, { timeout: Number(config.timeout) || 5, hold })).then(ends.executed, ends.failed)
        .catch((error) => this.error(error.message, {}));
      return undefined;
    });
  });
};
