// SPDX-License-Identifier: Apache-2.0
// What every node does alike: its dot, its bus, its end.
'use strict';

const { isThere, words } = require('./boards');
const { AsipError } = require('./protocol');

const short = (text) => (text.length > 20 ? `${text.slice(0, 19)}…` : text);

// The dot of a node of one board: grey no bus, yellow connecting, red board or bus gone, green online.
function showBoard(node, bus, name) {
  const board = bus.boards.get(name);
  if (!bus.ready) node.status({ fill: 'yellow', shape: 'ring', text: 'connecting' });
  else if (!board || board.state === 'unknown') node.status({ fill: 'red', shape: 'ring', text: 'not there' });
  else node.status({ fill: isThere(board) ? 'green' : 'red', shape: isThere(board) ? 'dot' : 'ring', text: short(words(board)) });
}

// The bus of a node's configuration, started. Calls `begin(bus)`, and what that returns when the node ends. null: none is chosen.
function withBus(RED, node, config, begin) {
  const server = RED.nodes.getNode(config.bus);
  if (!server || !server.bus) {
    node.status({ fill: 'grey', shape: 'ring', text: 'no bus chosen' });
    return null;
  }
  const { bus } = server;
  const show = () => showBoard(node, bus, config.board);
  const onBoard = (board) => { if (board.name === config.board) show(); };
  if (config.board) {
    bus.on('connected', show);
    bus.on('disconnected', show);
    bus.on('board', onBoard);
    show();
  }
  const end = begin ? begin(bus) : undefined;
  node.on('close', (done) => {
    bus.off('connected', show);
    bus.off('disconnected', show);
    bus.off('board', onBoard);
    try {
      if (end) end();
    } finally {
      done();
    }
  });
  return bus;
}

// Does what a node is asked for one after the other, so that their order is kept. What waits when the flow ends is not done any more.
function inTurn(node) {
  let last = Promise.resolve();
  let over = false;
  node.on('close', () => { over = true; });
  return (action) => {
    const result = last.then(() => {
      if (over) throw new AsipError('Closed', 'the flow has ended; nothing was sent');
      return action();
    });
    last = result.catch(() => {});
    return result;
  };
}

// Calls `again()` when the board is there: now, and each time it comes back. Returns a function that ends it.
function whenThere(bus, name, again) {
  let there = false;
  const look = () => {
    const is = bus.ready && isThere(bus.boards.get(name));
    if (is && !there) again();
    there = is;
  };
  const onBoard = (board) => { if (board.name === name) look(); };
  bus.on('connected', look);
  bus.on('disconnected', look);
  bus.on('board', onBoard);
  look();
  return () => {
    bus.off('connected', look);
    bus.off('disconnected', look);
    bus.off('board', onBoard);
  };
}

// Ends an input message with what a command came to: the dot, the outputs executed / failed / unknown, and the Catch node.
function outcome(node, bus, board, msg, send, done) {
  return {
    began: () => node.status({ fill: 'blue', shape: 'dot', text: 'waits for an answer' }),
    executed: (answer) => {
      showBoard(node, bus, board);
      try {
        send([{ ...msg, asip: { status: 'ok', proof: answer.proof }, payload: answer.answer ?? msg.payload }, null, null]);
      } finally {
        done();
      }
    },
    failed: (error) => { // an AsipError, or a fault of this package: either ends the message
      node.status({ fill: 'red', shape: 'dot', text: short(String(error.code ? `error ${error.code}` : error.reason || error.kind || error.message)) });
      const told = { ...msg, asip: { status: error.kind || error.name, code: error.code, reason: error.reason, text: error.message, sent: error.sent } };
      try {
        send(error.sent === null ? [null, null, told] : [null, told, null]);
      } finally {
        done(error);
      }
    },
  };
}

module.exports = { inTurn, outcome, showBoard, whenThere, withBus };
