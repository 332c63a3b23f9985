// SPDX-License-Identifier: Apache-2.0
// The configuration node: one bus, and the lists of the editor.
'use strict';

const { Bus } = require('../lib/bus');
const { readCredentials } = require('../lib/bus-address');
const { isThere } = require('../lib/boards');
const { commandsOf } = require('../lib/models');
const { validBoard } = require('../lib/protocol');

module.exports = (RED) => {
  RED.nodes.registerType('asip-bus', function AsipBus(config) {
    RED.nodes.createNode(this, config);
    try {
      const options = config.file ? readCredentials(config.file)
        : { brokers: config.broker, user: this.credentials.user, password: this.credentials.password, root: config.root };
      this.bus = new Bus({ by: 'node-red', ...options });
    } catch (error) {
      this.error(error.message);
      return;
    }
    this.bus.on('connected', () => this.log('connected'));
    this.bus.on('disconnected', (why) => this.log(why));
    this.bus.on('fault', (what) => this.error(what));
    this.bus.start();
    this.on('close', (_removed, done) => this.bus.close(done));
  }, { credentials: { user: { type: 'text' }, password: { type: 'password' } } });

  // Lists for the editor, of what is known at this moment. None of them changes anything.
  const list = (what) => (request, response) => {
    const server = RED.nodes.getNode(request.params.bus);
    if (!server || !server.bus) return response.status(503).json({ error: 'deploy the bus first' });
    return response.json(what(server.bus, request.query));
  };
  const may = RED.auth.needsPermission('asip.read');
  const services = (bus, query) => bus.boards.get(query.board)?.description.services || [];
  RED.httpAdmin.get('/asip/:bus/boards', may, list((bus) => [...bus.boards.all.values()].map((board) => ({ name: board.name, there: isThere(board) }))));
  RED.httpAdmin.get('/asip/:bus/services', may, list((bus, query) => services(bus, query).map((one) => ({ name: one.name, title: one.title || '' }))));
  // The list of a board that no node looks at yet comes a moment later.
  const properties = (bus, board) => [...(bus.standings.get(board)?.properties.values() ?? [])].map((one) => ({ id: one.id, name: one.name, access: one.access }));
  RED.httpAdmin.get('/asip/:bus/properties', may, (request, response) => {
    const { bus } = RED.nodes.getNode(request.params.bus) ?? {};
    const { board } = request.query;
    if (!bus) return response.status(503).json({ error: 'deploy the bus first' });
    if (bus.standings.get(board) || !validBoard(board)) return response.json(properties(bus, board));
    const end = bus.standings.watch(board, () => {});
    return setTimeout(() => { response.json(properties(bus, board)); end(); }, 300);
  });
  RED.httpAdmin.get('/asip/:bus/commands', may, list((bus, query) => commandsOf(bus.modelOf(query.board, query.service))));
};
