// SPDX-License-Identifier: Apache-2.0
// The boards on the bus: their state, why, and their services (docs/service-bus.md, "Liveness"). Pure.
'use strict';

const { readObject, validBoard } = require('./protocol');
const { STATES, readDescription } = require('./description');

const THERE = ['online', 'sleeping', 'updating'];
const WORDS = {
  __proto__: null,
  latched: 'STOPPED until it is resumed', unplugged: 'cable unplugged', silent: 'the board does not answer', 'agent-gone': 'its agent ended or lost the broker',
  expired: 'nothing renewed its lease', released: 'another program has its port', stopped: 'its agent was stopped', conflict: 'two agents claim its name',
};
const REASON_OF_WORD = { lost: 'agent-gone', offline: 'stopped', updating: 'released' };

class Boards {
  constructor() { this.all = new Map(); }

  get(name) { return this.all.get(name); }

  // Each returns the board where its state or description changed, else undefined. Times are seconds.
  onState(name, payload, now) {
    const word = payload.toString().replace(/[\r\n]+$/, '');
    if (word === '') {
      const gone = this.all.get(name);
      this.all.delete(name);
      return gone && { ...gone, state: 'forgotten' };
    }
    if (!STATES.includes(word) || !validBoard(name)) return undefined;
    const board = this.of(name);
    board.word = word;
    // A description says the state with its reason; only the broker's word for a board that was there is news.
    if (board.saysState && (THERE.includes(word) || !THERE.includes(board.state))) return undefined;
    return this.become(board, word, REASON_OF_WORD[word] || '', now);
  }

  onDescription(name, payload, retained, expiry, now) {
    const document = readDescription(readObject(payload, 1 << 16), name);
    if (!document) return undefined;
    const board = this.of(name);
    if (board.session === document.session && document.seq < board.seq) return undefined;
    if (retained && board.session > document.session) return undefined;
    const news = board.session !== document.session || document.seq > board.seq;
    const { lease } = document;
    board.deadline = now + (retained && expiry !== undefined ? Math.min(expiry, lease) : lease);
    if (!news) return undefined;
    Object.assign(board, { session: document.session, seq: document.seq, description: document });
    const said = document.state;
    board.saysState = Boolean(said);
    // What is retained on `$state` is newer than a description that is retained: a will does not change that.
    const older = retained && board.word && !THERE.includes(board.word) && board.saysState && THERE.includes(said.is);
    const changed = older ? undefined : board.saysState ? this.become(board, said.is, said.reason || '', now)
      : board.state === 'unknown' ? this.become(board, 'online', '', now) : undefined;
    return changed || board;
  }

  // The boards whose lease is over since the last call.
  expire(now) {
    const lost = [];
    for (const board of this.all.values()) {
      if (THERE.includes(board.state) && board.deadline !== undefined && now >= board.deadline) {
        board.saysState = false;
        lost.push(this.become(board, 'lost', 'expired', now));
      }
    }
    return lost;
  }

  of(name) {
    if (!this.all.has(name)) this.all.set(name, { name, state: 'unknown', reason: '', session: '', seq: -1, description: { services: [], labels: {} } });
    return this.all.get(name);
  }

  become(board, state, reason, now) {
    const changed = board.state !== state;
    if (changed) board.since = now;
    Object.assign(board, { state, reason });
    return changed ? board : undefined;
  }
}

const isThere = (board) => Boolean(board) && THERE.includes(board.state);
// `lost: cable unplugged`
const words = (board) => (board.reason && board.state !== 'online' ? `${board.state}: ${WORDS[board.reason] || board.reason}` : board.state);

module.exports = { Boards, THERE, isThere, words };
