// SPDX-License-Identifier: Apache-2.0
// The boards on the bus: their state, why, since when, and their services (docs/service-bus.md, "Presence"). Pure. It says what `asip/catalogue` of
// the C++ programs says after the same messages: tests/vectors/presence.json binds both. Times are seconds of a monotonic clock.
'use strict';

const { readObject, validBoard } = require('./protocol');
const { STATES, DEFAULT_LEASE, readDescription } = require('./description');

const THERE = ['online', 'sleeping', 'updating'];
const STATE_EXPIRY = 3e9; // `$state` is published with it: what is left of it says how old a retained one is
const APART = 2; // ages of stored messages are whole seconds, and messages take a while: what is less apart may be one moment
const GRACE = 10; // for leases, after the broker was away
const FORGET_AFTER = 7 * 86400;
const MAX_OLD_SESSIONS = 8;
const WORDS = {
  __proto__: null,
  unplugged: 'cable unplugged', silent: 'the board answers nothing', 'agent-gone': 'its agent died or lost the broker', expired: 'its agent fell silent and the lease ran out',
  released: 'its port is in other hands', stopped: 'its agent was stopped', conflict: 'two agents claim its name', latched: 'STOPPED until it is resumed',
};
const REASON_OF_WORD = { lost: 'agent-gone', offline: 'stopped', updating: 'released' };
const isThereWord = (word) => THERE.includes(word);
// Sessions of our agents begin with the time of their start; those of other programs have no order.
const isTimed = (session) => /^[0-9a-f]{16}(-|$)/.test(session);
const isOlder = (session, than) => isTimed(session) && isTimed(than) && session < than;

class Board {
  constructor(name, now) {
    Object.assign(this, {
      name, reported: 'online', reportedReason: '', reportedSince: -Infinity, effective: 'lost', judgedReason: '', since: now, session: '', seq: -1, lease: DEFAULT_LEASE,
      description: { services: [], labels: {} }, described: false, saysState: false, saidAt: -Infinity, // when its state was said last, as far as can be known
      proven: false, deadline: now, firstSeen: now, lastHeard: -Infinity, sessionEnds: -Infinity, // the lease of its session's descriptions, without grace
      epochHeard: 0, epochGone: 0, keptUntil: -Infinity, oldSessions: new Map(), challenger: undefined,
      hinted: false, // only a retained word says that it is there
    });
  }

  get state() { return this.hinted ? 'unknown' : this.effective; }

  get reason() { return this.conflict && !this.judgedReason ? 'conflict' : this.judgedReason; }

  get conflict() { return Boolean(this.challenger?.confirmed); }

  alive(now) { return isThereWord(this.reported) && now < this.deadline; }

  // Messages that say the same again can only be later than the moment, so the earliest counts, unless the board left the state
  // meanwhile and came into it again.
  say(state, word, moment, now) {
    const reason = word in WORDS ? word : '';
    let since = moment;
    if (this.reported === state && this.reportedReason === reason && this.reportedSince !== -Infinity) {
      if (since === -Infinity) since = this.reportedSince;
      if (Math.abs(since - this.reportedSince) < APART) since = Math.min(since, this.reportedSince);
    }
    Object.assign(this, { reported: state, reportedReason: reason, reportedSince: Math.min(since, now) });
  }

  // An agent publishes the state in its description before the same on `$state`: so a retained `$state` that says something else of a
  // board that was there is newer, and the word of the broker, unless the description is the younger one. The board was there behind
  // what was known of it, and is gone anew.
  takeSaidState(retained, published, newSession, epoch, now) {
    const said = this.description.state;
    this.saysState = said !== undefined;
    if (!this.saysState) return;
    const word = retained && this.epochGone === epoch && !isThereWord(this.reported) && said.is !== this.reported;
    const isYounger = this.saidAt !== -Infinity && published > this.saidAt + APART;
    if (word && !isYounger) {
      this.reportedSince = -Infinity;
      this.say(this.reported, REASON_OF_WORD[this.reported] ?? '', this.saidAt, now);
      return;
    }
    const saidAt = published === -Infinity ? now : published;
    this.saidAt = saidAt;
    if (newSession) this.reportedSince = -Infinity; // it came into its state when it says, though the one before it had been in the same
    this.say(said.is, said.reason ?? '', saidAt - (said.age ?? 0), now);
  }

  // 'accept', 'renew' or 'refuse': what a description of this session is.
  judge({ session, seq, lease }, retained, published, now) {
    if (!this.described) return 'accept';
    if (this.session !== session) return this.judgeOtherSession({ session, seq, lease }, retained, published, now) ? 'accept' : 'refuse';
    if (seq <= this.seq) return seq < this.seq ? 'refuse' : 'renew';
    if (!retained && this.challenger) {
      if (now >= this.challenger.deadline) this.challenger = undefined;
      else this.challenger.answered = true;
    }
    return 'accept';
  }

  // A later session counts, whatever was before. An earlier one counts by what it says after the lease of the later one: the clock of its
  // agent went back, and nothing on the bus told it of the later one.
  judgeOtherSession({ session, seq, lease }, retained, published, now) {
    const old = this.oldSessions.get(session);
    if (old !== undefined && seq <= old) return false;
    const earlier = isOlder(session, this.session);
    const tooEarly = earlier && published < this.sessionEnds;
    if (tooEarly) this.remember(session, seq); // for ever, however late a bridge delivers it again
    if (tooEarly || (!earlier && !isOlder(this.session, session))) {
      const holderLives = this.alive(now) && this.proven;
      if (retained) {
        if (earlier || old !== undefined || holderLives) return false;
      } else if (holderLives) {
        const disputed = this.conflict && now < this.challenger.deadline;
        if (earlier || old !== undefined || disputed) return this.challenge(session, seq, lease, now);
      } else if (earlier) return false;
    }
    this.takeOver(session);
    return true;
  }

  // Another session lives beside the holder, or lived when its message was sent. Only one that comes after the holder has answered proves
  // that both live; then the larger session holds the board.
  challenge(session, seq, lease, now) {
    if (this.oldSessions.has(session)) this.oldSessions.set(session, seq);
    if (this.challenger?.session !== session) {
      const known = this.conflict;
      this.challenger = { session, answered: known, confirmed: known };
    }
    const other = this.challenger;
    Object.assign(other, { confirmed: other.confirmed || other.answered, seq, deadline: now + lease });
    if (!(other.confirmed && this.session < session)) return false;
    this.takeOver(session);
    return true;
  }

  // The newest last, with the highest seq seen.
  remember(session, seq) {
    this.oldSessions.set(session, Math.max(seq, this.oldSessions.get(session) ?? seq));
    if (this.oldSessions.size > MAX_OLD_SESSIONS) this.oldSessions.delete(this.oldSessions.keys().next().value);
  }

  // The old session is remembered, so that its old messages cannot come back.
  takeOver(session) {
    this.oldSessions.delete(session);
    this.remember(this.session, this.seq);
    const other = this.challenger;
    if (other?.session === session) {
      if (other.confirmed) Object.assign(other, { session: this.session, seq: this.seq, deadline: this.deadline });
      else this.challenger = undefined;
    }
    Object.assign(this, { session, seq: 0, sessionEnds: -Infinity, deadline: -Infinity, proven: false, epochHeard: 0 });
  }

  // What the grace after an interruption added is no time in which the board was there. Words beside descriptions without a state open a
  // lease, too.
  leaseEnded() {
    const renewed = this.saysState ? -Infinity : Math.max(this.lastHeard, this.saidAt) + this.lease;
    return Math.min(this.deadline, Math.max(this.sessionEnds, renewed));
  }

  // Brings the effective state into line with what was reported and the lease; whether it changed.
  update(now, added) {
    const is = this.alive(now) || !isThereWord(this.reported) ? this.reported : 'lost';
    const judged = is !== this.reported; // by its lease
    const was = this.effective;
    this.effective = is;
    this.keptUntil = -Infinity;
    if (was !== is || added) {
      const unknown = judged ? added || this.deadline === -Infinity : !isThereWord(is) && this.reportedSince === -Infinity;
      const otherwise = judged ? this.leaseEnded() : now;
      this.since = unknown ? -Infinity : otherwise;
    }
    if (!judged && this.reportedSince !== -Infinity && (this.saysState || !isThereWord(is))) this.since = this.reportedSince;
    this.judgedReason = judged ? 'expired' : this.reportedReason;
    if (was !== is && this.conflict && !this.alive(now)) this.challenger = undefined;
    return was !== is || Boolean(added);
  }
}

class Boards {
  constructor() {
    this.all = new Map();
    this.epoch = 1;
    this.heard = true; // while the broker is not, no lease is judged
  }

  get(name) { return this.all.get(name); }

  connected(now) {
    this.heard = true;
    this.epoch += 1;
    for (const board of this.all.values()) {
      if (isThereWord(board.effective)) board.deadline = Math.max(board.deadline, now + Math.min(GRACE, board.lease));
      else board.keptUntil = now + GRACE;
    }
  }

  disconnected() { this.heard = false; }

  // Each returns the board where its state or description changed, else undefined.
  onDescription(name, payload, retained, expiry, now) {
    const document = readDescription(readObject(payload, 1 << 16), name);
    if (!document) return undefined;
    const added = !this.all.has(name);
    const board = this.of(name, now);
    const { described } = board;
    const other = board.session !== document.session;
    let published = retained ? -Infinity : now;
    if (expiry !== undefined) published = now - Math.max(0, document.lease - expiry);
    const verdict = board.judge(document, retained, published, now);
    if (verdict === 'refuse') return undefined;
    if (verdict === 'accept') {
      if (!described) board.deadline = board.sessionEnds = -Infinity; // that of a word ahead of it was a guess
      Object.assign(board, { session: document.session, seq: document.seq, lease: document.lease, description: document, described: true });
      board.takeSaidState(retained, published, other || !described, this.epoch, now);
      if (!board.saysState && !retained && described && other && !isThereWord(board.reported)) board.say('online', '', now, now);
    }
    if (published !== -Infinity || verdict === 'accept') { // from when it was published: a bridge may deliver one late, or again
      const ends = (published === -Infinity ? now : published) + board.lease;
      const sets = !retained && verdict === 'accept'; // a lease that became shorter, too
      board.sessionEnds = sets ? ends : Math.max(board.sessionEnds, ends);
      board.deadline = sets ? ends : Math.max(board.deadline, board.sessionEnds);
    }
    if (!retained) {
      Object.assign(board, { proven: true, lastHeard: Math.max(board.lastHeard, published) });
      if (board.saysState) board.epochHeard = this.epoch;
    }
    board.hinted = false;
    return board.update(now, added) || verdict === 'accept' ? board : undefined;
  }

  onState(name, payload, retained, expiry, now) {
    if (!validBoard(name)) return undefined;
    const known = this.all.get(name);
    // Another program forgot this board: so does this one, unless it is known to be there.
    if (payload.length === 0) return known && !isThereWord(known.effective) ? this.forget(known) : undefined;
    const word = payload.toString().replace(/[\r\n ]+$/, '');
    if (!STATES.includes(word) || (known && retained && known.epochHeard === this.epoch)) return undefined;
    const there = isThereWord(word);
    const board = known ?? this.of(name, now);
    board.hinted = retained && there && (!known || known.hinted);
    const published = expiry !== undefined && expiry <= STATE_EXPIRY ? now - (STATE_EXPIRY - expiry) : undefined;
    // A bridge delivers what it has stored again: the agent has said more since then.
    if (board.saysState && !there && published !== undefined && published + APART < board.saidAt) return undefined;
    // The newer of two words counts, also where both say that it is not there: a will comes after a stop, too, and the description that came
    // with a stop may have come and gone while nothing was heard.
    const goneOtherwise = !there && !isThereWord(board.reported) && word !== board.reported && (!retained || published !== undefined);
    // It was there again behind all that is known of it.
    const wasBack = there && retained && !isThereWord(board.effective) && published > Math.max(board.saidAt, board.since);
    const again = retained && published <= board.saidAt + APART && word === board.reported;
    if ((!board.saysState && !again) || (!there && isThereWord(board.reported)) || goneOtherwise || wasBack) {
      const moment = !retained && (!known || word !== board.reported) ? now : -Infinity;
      board.say(word, REASON_OF_WORD[word] ?? '', retained && published !== undefined ? published : moment, now);
    }
    if (there && published !== undefined && board.described && !board.saysState) board.deadline = Math.max(board.deadline, published + board.lease);
    // No description told a lease: behind an interruption the board has to be heard again.
    if (retained && !board.described) board.deadline = Math.min(board.deadline, now + GRACE);
    // The broker has forgotten the description that said so: when the lease ended is not known.
    if (wasBack && (board.saysState || !board.described || board.deadline <= now)) board.deadline = board.since = -Infinity;
    if (!there && board.reported === word) board.epochGone = this.epoch;
    // Beside descriptions that hold the state, a word that the board is there says nothing: the description that came with it may never be
    // heard.
    if (!there || !board.saysState) board.saidAt = Math.max(board.saidAt, published ?? (retained ? -Infinity : now));
    if (!retained && !board.saysState && there) Object.assign(board, { deadline: now + board.lease, lastHeard: now });
    if (!retained) board.epochHeard = this.epoch;
    return board.update(now, !known) ? board : undefined;
  }

  // The boards that were lost, or forgotten, since the last call, because their lease is over.
  expire(now) {
    const changed = [];
    for (const board of this.heard ? [...this.all.values()] : []) {
      if (isThereWord(board.effective) && now >= board.deadline && board.update(now, false)) changed.push(board);
      const gone = board.since === -Infinity ? board.firstSeen : board.since;
      if (!isThereWord(board.effective) && now >= Math.max(Math.max(gone, board.lastHeard) + FORGET_AFTER, board.keptUntil)) changed.push(this.forget(board));
    }
    return changed;
  }

  of(name, now) {
    if (!this.all.has(name)) this.all.set(name, new Board(name, now));
    return this.all.get(name);
  }

  forget(board) {
    this.all.delete(board.name);
    return { name: board.name, state: 'forgotten', reason: '', since: -Infinity, description: board.description };
  }
}

const isThere = (board) => Boolean(board) && isThereWord(board.state);

function duration(seconds) {
  for (const [size, unit] of [[86400, 'd'], [3600, 'h'], [60, 'min']]) if (seconds >= size) return `${Math.floor(seconds / size)} ${unit}`;
  return `${Math.floor(seconds)} s`;
}

// `lost: cable unplugged`; with the time, `lost 3 min ago: cable unplugged`
function words(board, now) {
  const ago = now === undefined || board.since === -Infinity || now - board.since < 1 ? '' : ` ${duration(now - board.since)} ago`;
  const why = WORDS[board.reason];
  return `${board.state}${ago}${why && board.state !== 'online' ? `: ${why}` : ''}`;
}

module.exports = { Boards, THERE, WORDS, isThere, words };
