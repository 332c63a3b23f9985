// SPDX-License-Identifier: Apache-2.0
// Names, topics, requests, answers and agents' clocks: docs/service-bus.md. Pure; tested with the vectors of tests/vectors/bus.json.
'use strict';

const NAME = /^[A-Za-z0-9._-]{1,64}$/;

const isObject = (value) => Boolean(value) && typeof value === 'object' && !Array.isArray(value);
const validName = (name) => typeof name === 'string' && NAME.test(name) && name !== '.' && name !== '..';
const validBoard = (name) => validName(name) && name !== 'servicebus' && name !== 'registry';

// A user of the broker as one level of a topic.
const userLevel = (user) => (!user || /[\u0000-\u001f\u007f+#/]/.test(user) ? '$nobody' : user);

// All topics of one program. `client` is a name that no other program has.
function makeTopics(root, user, client) {
  const reply = (asked) => `${root}/reply/${userLevel(user)}/${asked}/${client}`;
  return {
    state: (board) => `${root}/servicebus/${board}/$state`,
    description: (board) => `${root}/servicebus/${board}/$description`,
    demand: (board) => `${root}/servicebus/${board}/$demand/${userLevel(user)}/${client}`,
    probe: () => `${root}/servicebus/$probe`,
    query: () => `${root}/registry/query`,
    lines: (board) => `${root}/${board}/in`,
    command: (board, service) => `${root}/${board}/${service}/in`,
    stop: (board) => `${root}/${board}/$stop`,
    event: (board, service) => `${root}/${board}/${service}/out`,
    fault: (board, service) => `${root}/${board}/${service}/error`,
    properties: (board) => `${root}/servicebus/${board}/$properties`,
    values: (board) => `${root}/${board}/$values`,
    question: (board) => `${root}/servicebus/${board}/$demand/${userLevel(user)}/${client}-values`,
    reply,
    replies: () => reply('+'),
    own: () => reply('$self'),
    // The levels below the root; null for another topic.
    split: (topic) => (topic.startsWith(`${root}/`) ? topic.slice(root.length + 1).split('/') : null),
  };
}

const milliseconds = (seconds) => Math.min(60000, Math.max(50, Math.round(seconds * 1000)));

// A request as an object: everything stands in the JSON, because bridges of MQTT 3.1.1 drop properties of MQTT 5.
function makeRequest(members, { replyTo, id, timeout, clock, by, hold }) {
  const request = { ...members, reply_to: replyTo, id };
  if (timeout !== undefined) request.deadline_ms = milliseconds(timeout);
  if (hold !== undefined) request.hold_ms = milliseconds(hold);
  if (clock !== undefined) request.clock = clock;
  if (by !== undefined) request.by = by;
  return request;
}

// Why a command was not executed for certain. `sent`: false, the board has not seen it; true, it refused it; null, that is not known.
class AsipError extends Error {
  constructor(kind, text, { sent = false, reason, code, board, service } = {}) {
    super(text);
    this.name = this.kind = kind; // BoardError, Refused, NotThere, Invalid, Unproven, Disconnected
    Object.assign(this, { sent, reason, code, board, service });
  }
}

const MAYBE = '; it may or may not have been executed';
const TIMEOUTS = {
  __proto__: null,
  '': 'the board gave no proof in time',
  doubt: 'something on the line to the board was lost or damaged',
  partly: 'some of its lines were sent and others were not',
  'no-value': 'it was executed, but the value that was asked for did not come',
  'board-not-there': 'the board did not confirm it in time',
  'no-answer': 'nothing answered in time',
  connection: 'the connection to the broker broke before the answer came',
};
const REFUSALS = {
  __proto__: null,
  invalid: 'the board has no such command, or not with these arguments',
  'queue-full': 'too many commands wait',
  'board-not-there': 'the board is not there',
  deadline: 'its time was over before it could be sent',
  'id-reused': 'another command had this id within the last minute',
  retained: 'a stored command is never executed',
  stopped: 'the board was stopped',
  'not-held': 'there is nothing to renew',
  released: 'the port is in other hands',
  'not-released': 'the port was not released',
  'speaks-asip': 'the board runs ASIP already',
  'not-loaded': 'the firmware was not loaded',
  'not-kept': 'it could not be kept',
  denied: "the broker's access rules deny it",
};
const KINDS = { __proto__: null, 'board-not-there': 'NotThere', invalid: 'Invalid' };
const textMember = (answer, name) => (typeof answer[name] === 'string' ? answer[name] : '');
const codeOf = (answer) => (Number.isInteger(answer.code) ? answer.code : 0);

// What a final answer means, as every program says it: tests/vectors/answers.json. Empty: it was executed.
function sentenceOf(answer) {
  const [reason, words] = [textMember(answer, 'reason'), textMember(answer, 'error')];
  switch (answer.status) {
    case 'ok': return '';
    case 'error': return `the board refused it${words && `: ${words}`} (error ${codeOf(answer)})`;
    case 'refused': return ['refused', reason && ` (${reason})`, (words || REFUSALS[reason]) && `: ${words || REFUSALS[reason]}`].filter(Boolean).join('');
    case 'timeout': return `${words || (TIMEOUTS[reason] ?? TIMEOUTS[''])}${reason === 'no-value' ? '' : MAYBE}`;
    default: return `the answer cannot be read${MAYBE}`;
  }
}

// The error that a final answer stands for; null where its status is "ok".
function errorOf(answer, board, service) {
  const { status } = answer;
  if (status === 'ok') return null;
  const reason = textMember(answer, 'reason') || undefined;
  const names = { board, service, reason };
  const text = `${service ? `${board}/${service}` : board}: ${sentenceOf(answer)}`;
  if (status === 'error') return new AsipError('BoardError', text, { ...names, sent: true, code: codeOf(answer) });
  if (status === 'refused') return new AsipError(KINDS[reason] ?? 'Refused', text, names);
  return new AsipError('Unproven', text, { ...names, sent: null });
}

// What this program knows of the clocks of the agents that it commands. Times are seconds of a monotonic clock.
class Clocks {
  constructor() { this.ahead = new Map(); }

  note(board, reading, asked, answered) {
    const parts = typeof reading === 'string' && reading.length <= 64 ? /^([^-]+)-([0-9]+)$/.exec(reading) : null;
    if (!parts) return;
    const known = this.ahead.get(board);
    const most = (Number(parts[2]) + 1) / 1000 - asked;
    const least = Number(parts[2]) / 1000 - answered;
    if (known && known.start === parts[1] && known.most >= least && most >= known.most) return;
    if (!known && this.ahead.size >= 16384) this.ahead.clear();
    this.ahead.set(board, { start: parts[1], most });
  }

  // What the clock shows at `now`, never less than it does; empty: not known.
  reading(board, now) {
    const known = this.ahead.get(board);
    return known ? `${known.start}-${Math.max(0, Math.floor((now + known.most) * 1000 + 1e-6))}` : '';
  }
}

const MAX_DEPTH = 32;
// Numbers that may be beyond what a double holds: such a text is read with care.
const ODD = /[0-9.][eE]\+?[0-9]{3}|[0-9]{300}/;

// Refuses numbers without an end.
function finite(key, value) {
  if (typeof value === 'number' && !Number.isFinite(value)) throw new RangeError(key);
  return value;
}

// Whether it nests at most MAX_DEPTH deep.
function isFlat(value) {
  let level = [value];
  for (let depth = 0; depth < MAX_DEPTH; depth += 1) {
    level = level.flatMap((one) => Object.values(one)).filter((one) => one && typeof one === 'object');
    if (!level.length) return true;
  }
  return false;
}

// A JSON object of a payload; null for anything else.
function readObject(payload, limit = 1 << 20) {
  if (payload.length > limit) return null;
  try {
    const text = payload.toString();
    const value = ODD.test(text) ? JSON.parse(text, finite) : JSON.parse(text);
    return isObject(value) && isFlat(value) ? value : null;
  } catch {
    return null;
  }
}

// Whether a name fits a pattern with * and ?.
function matches(pattern, name) {
  const text = pattern.replace(/[.+^${}()|[\]\\]/g, '\\$&').replace(/\*/g, '.*').replace(/\?/g, '.');
  return new RegExp(`^${text}$`).test(name);
}

module.exports = { isObject, validName, validBoard, makeTopics, makeRequest, AsipError, errorOf, sentenceOf, Clocks, readObject, matches };
