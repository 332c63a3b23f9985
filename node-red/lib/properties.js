// SPDX-License-Identifier: Apache-2.0
// What can be read and set on a board, and how it stands, as its agent tells it (docs/service-bus.md, "Properties and their values"). Pure.
// tests/vectors/properties.json binds it to the C++ programs, which make the list.
'use strict';

const { isObject, readObject, validBoard, validName } = require('./protocol');

const VERSION = 1;
const EVENTS = ['press', 'release', 'hold', 'double']; // what is done with a button
const KINDS = ['sensor', 'binary', 'switch', 'number', 'light', 'button', 'text', 'select'];
const TYPES = [undefined, 'boolean', 'boolean', undefined, 'light', 'action', 'text', 'choice']; // of each kind; undefined: other members say it
const MAX_PROPERTIES = 256;
const FULL = 255; // brightness
const UNKNOWN = {
  __proto__: null,
  never: 'nothing was reported or set yet', restart: 'nothing was reported or set since the board came back', doubt: 'a command may or may not have been executed',
};
const seen = ['detected', 'clear'];
const TWO_WORDS = {
  __proto__: null, button: ['pressed', 'released'], door: ['open', 'closed'], window: ['open', 'closed'], moisture: ['wet', 'dry'],
  motion: seen, occupancy: seen, smoke: seen, vibration: seen,
};

function need(is, what) {
  if (!is) throw new TypeError(`a board's properties or values are damaged: ${what}`);
}
const own = (object, name, fallback) => (Object.hasOwn(object, name) ? object[name] : fallback);
const isWhole = (value, most = Number.MAX_SAFE_INTEGER) => Number.isSafeInteger(value) && value >= 0 && value <= most;
const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
const isShort = (text) => typeof text === 'string' && Buffer.byteLength(text) <= 256 && !/[\u0000-\u001f\u007f]/.test(text);

function readCall(call) {
  need(Array.isArray(call) && call.length > 0 && call.length <= 17 && typeof call[0] === 'string'
    && call.slice(1).every((one) => one === null || isNumber(one)), 'command');
  return { command: call[0], args: call.slice(1) };
}

// The members that a list leaves out, since others say them.
function usual(one) {
  const isSettable = Object.hasOwn(one, 'write') || Object.hasOwn(one, 'color');
  const kind = own(one, 'kind', isSettable ? 'number' : 'sensor');
  const id = isShort(one.id) ? one.id : '';
  const isTwo = kind === 'binary' || kind === 'switch';
  return {
    service: id.split('/', 1)[0],
    name: id.replace(/[/_.-]/g, ' ').replace(/^[a-z]/, (letter) => letter.toUpperCase()),
    kind,
    type: TYPES[KINDS.indexOf(kind)] ?? (own(one, 'max_length') ? 'text' : own(one, 'choices') ? 'choice' : 'integer'),
    read: !isSettable && ['sensor', 'binary'].includes(kind) ? `/${id}` : '',
    access: !isSettable ? 'read' : kind === 'button' ? 'write' : 'both',
    choices: isTwo ? [['off', 0], ['on', 1]] : [],
  };
}

function readProperty(said) {
  need(isObject(said), 'property');
  const one = { ...usual(said), ...said };
  const told = { calls: {} };
  for (const name of ['id', 'name', 'service', 'kind', 'type', 'access', 'unit', 'quantity', 'read', 'refused']) {
    told[name] = own(one, name, '');
    need(isShort(told[name]), name);
  }
  for (const name of ['min', 'max', 'step', 'none']) {
    if (Object.hasOwn(one, name)) told[name] = one[name];
    need(told[name] === undefined || isNumber(told[name]), name);
  }
  const choices = own(one, 'choices', []);
  Object.assign(told, { maxLength: own(one, 'max_length', 0), meaning: own(one, 'meaning', {}), isWhole: told.type === 'integer' });
  need(`${told.id}/`.startsWith(`${told.service}/`) && validName(told.service) && KINDS.includes(told.kind), 'id, service or kind');
  need(isWhole(told.maxLength, 256) && (told.maxLength > 0 || told.kind !== 'text'), 'max_length');
  need(Array.isArray(choices) && choices.length <= 64 && choices.every((pair) => Array.isArray(pair) && pair.length === 2 && typeof pair[0] === 'string' && isNumber(pair[1])), 'choices');
  told.choices = new Map(choices);
  const isTwo = told.kind === 'switch' || told.kind === 'binary' || (told.kind === 'light' && told.choices.size > 0);
  need(!isTwo || (told.choices.size === 2 && told.choices.has('on') && told.choices.has('off')), 'choices');
  need(isObject(told.meaning) && typeof own(told.meaning, 'class', '') === 'string', 'meaning');
  for (const name of ['before', 'write', 'color']) if (Object.hasOwn(one, name)) told.calls[name] = readCall(one[name]);
  need(told.read ? told.read.startsWith('/') : told.calls.write || told.calls.color, 'read');
  return told;
}

function readList(properties) {
  need(Array.isArray(properties) && properties.length <= MAX_PROPERTIES, 'properties');
  const all = new Map();
  for (const one of properties) {
    const told = readProperty(one);
    need(!all.has(told.id), `${told.id} twice`);
    all.set(told.id, told);
  }
  return all;
}

function readValue(one, now) {
  need(isObject(one), 'value');
  const age = own(one, 'age', 0);
  const how = own(one, 'how', '');
  const why = own(one, 'unknown', '');
  const events = own(one, 'events', []);
  const isKnown = ['reported', 'answered', 'set'].includes(how);
  need(isNumber(age) && age >= 0 && age <= 1e10 && typeof how === 'string' && typeof why === 'string' && (!isKnown || Object.hasOwn(one, 'value')), 'value');
  need(Array.isArray(events) && events.length <= 64 && events.every((each) => Array.isArray(each) && each.length === 2 && isWhole(each[0]) && typeof each[1] === 'string'), 'events');
  return {
    value: isKnown ? one.value : undefined, how: isKnown ? how : '', why: isKnown ? '' : why in UNKNOWN ? why : 'never', since: now - age,
    events: events.filter(([, word]) => EVENTS.includes(word)),
  };
}

function readValues(document, now) {
  const values = own(document, 'values');
  const pins = own(document, 'pins', {});
  need(isObject(values) && Object.keys(values).length <= MAX_PROPERTIES && typeof own(document, 'clock', '') === 'string', 'values');
  need(Object.keys(values).every(isShort), 'ids');
  need(isObject(pins) && Object.values(pins).every(isObject) && isWhole(own(document, 'left_out', 0), MAX_PROPERTIES), 'pins');
  need(isWhole(own(document, 'restarts', 0)), 'restarts');
  return new Map(Object.entries(values).map(([id, one]) => [id, readValue(one, now)]));
}

function readHead(document, board) {
  need(isObject(document), 'document');
  need(own(document, 'version') === VERSION, 'version');
  need(own(document, 'board') === board && validBoard(board), 'board');
  need(validName(own(document, 'session')), 'session');
  need(isWhole(own(document, 'seq')), 'seq');
}

const NONE = { session: '', seq: -1 }; // no document came

// The list and the values of one board, of the documents that come. Throws TypeError for what is none.
class Standing {
  constructor() {
    Object.assign(this, { properties: new Map(), values: new Map(), isListed: false, heads: { list: NONE, values: NONE }, lastAct: { session: '', number: 0 } });
    this.acts = []; // what was done with buttons by the values that came last: [id, word], each once
  }

  // `holder`: the session of the board's description. Whether it counts; an empty one clears.
  takeList(payload, board, holder) {
    const document = payload.length ? readObject(payload) : {};
    if (payload.length) readHead(document, board);
    const properties = readList(payload.length ? own(document, 'properties') : []);
    if (payload.length && !this.counts('list', document, holder)) return false;
    Object.assign(this, { properties, isListed: payload.length > 0 });
    if (!payload.length) this.heads.list = NONE;
    return true;
  }

  // `stored`: the broker kept it; what was done with a button is of an earlier time.
  takeValues(payload, board, holder, now, stored = false) {
    this.acts = [];
    const document = payload.length ? readObject(payload) : { values: {} };
    if (payload.length) readHead(document, board);
    const values = readValues(document, now);
    if (payload.length && !this.counts('values', document, holder)) return false;
    this.values = values;
    if (!payload.length) this.heads.values = NONE;
    else this.takeActs(document.session, stored);
    return true;
  }

  takeActs(session, stored) {
    const last = session === this.lastAct.session ? this.lastAct.number : 0;
    const fresh = [...this.values].flatMap(([id, { events }]) => events.map(([number, word]) => [number, id, word])).filter(([number]) => number > last).sort(([a], [b]) => a - b);
    this.lastAct = { session, number: fresh.at(-1)?.[0] ?? last };
    if (!stored) this.acts = fresh.map(([, id, word]) => [id, word]);
  }

  // A document of the session in the description counts, else that of the later session; within one session the later document.
  counts(what, { session, seq }, holder) {
    const old = this.heads[what];
    const isGood = session === old.session ? seq >= old.seq // else its description may be on its way
      : session === holder || ((old.session === '' || old.session !== holder) && session >= old.session && session >= holder);
    if (isGood) this.heads[what] = { session, seq };
    return isGood;
  }
}

const isWithin = (told, value) => isNumber(value) && (told.min === undefined || value >= told.min) && (told.max === undefined || value <= told.max);
const request = (told, name, value) => [told.service, { [told.calls[name].command]: told.calls[name].args.map((one) => (one === null ? value : one)) }];

function lightRequests(told, value) {
  const isGood = (name, most) => !Object.hasOwn(value, name) || (isNumber(value[name]) && value[name] >= 0 && value[name] <= most);
  if (!isObject(value) || typeof value.on !== 'boolean' || !isGood('brightness', FULL) || !isGood('color', 0xffffff)) return [];
  const { on } = value;
  const made = [];
  const dims = told.calls.write !== undefined;
  if (told.calls.color && (!on || Object.hasOwn(value, 'color') || !dims) && (on || !dims)) made.push(request(told, 'color', on ? value.color ?? 0xffffff : 0));
  if (dims && told.choices.size) made.push(request(told, 'write', told.choices.get(on ? 'on' : 'off')));
  else if (dims) {
    const brightness = on ? value.brightness ?? FULL : 0;
    made.push(request(told, 'write', brightness > 0 ? Math.max(1, Math.round((brightness * (told.max ?? FULL)) / FULL)) : 0));
  }
  return made;
}

// What stands for a value on the wire to the board; undefined: it has no such value.
function wireOf(told, value) {
  if (told.kind === 'text') return typeof value === 'string' && Buffer.byteLength(value) <= told.maxLength ? value : undefined;
  if (told.kind === 'number') return isWithin(told, value) && (!told.isWhole || Number.isInteger(value)) ? value : undefined;
  if (told.kind === 'switch') return typeof value === 'boolean' ? told.choices.get(value ? 'on' : 'off') : undefined;
  return told.kind === 'select' && typeof value === 'string' ? told.choices.get(value) : undefined;
}

// What sets a property to a value, in order: [service, request]. Empty: it has no such value, or cannot be set.
function requestsFor(told, value) {
  let made = [];
  if (told.kind === 'light') made = lightRequests(told, value);
  else if (told.calls.write) {
    const wire = told.kind === 'button' ? null : wireOf(told, value);
    if (wire !== undefined) made = [request(told, 'write', wire)];
  }
  return made.length && told.calls.before ? [request(told, 'before', null), ...made] : made;
}

// A value for people: `open`, `42 cm`.
function textOf(told, value) {
  if (value === null) return 'none';
  if (typeof value === 'boolean') return (TWO_WORDS[told.meaning.class] ?? ['on', 'off'])[value ? 0 : 1];
  if (typeof value === 'string') return value;
  if (typeof value !== 'object') return `${value}${told.unit && told.unit !== '%' ? ' ' : ''}${told.unit}`;
  if (value.on !== true) return 'off';
  const color = Number.isInteger(value.color) ? `, #${(value.color & 0xffffff).toString(16).padStart(6, '0')}` : '';
  return `on${isNumber(value.brightness) ? `, ${Math.trunc(value.brightness)} of ${FULL}` : ''}${color}`;
}

// The boards of one bus whose standing nodes want.
class Standings {
  // bus: topics, boards, link, guard() and now() of its connection.
  constructor(bus, now) {
    Object.assign(this, { bus, now, all: new Map() });
  }

  topics() { return [...this.all.keys()].flatMap((board) => [this.bus.topics.properties(board), this.bus.topics.values(board)]); }

  get(board) { return this.all.get(board)?.standing; }

  // Calls `look(standing, acts)` now and after each change; returns a function that ends it.
  watch(board, look) {
    const watched = this.all.get(board) ?? { standing: new Standing(), looks: new Set() };
    const isNew = !this.all.has(board);
    this.all.set(board, watched);
    watched.looks.add(look);
    if (isNew && this.bus.link?.connected) this.bus.link.subscribe([this.bus.topics.properties(board), this.bus.topics.values(board)], { qos: 1 });
    setImmediate(() => watched.looks.has(look) && this.bus.guard(`what is known of ${board}`, () => look(watched.standing, [])));
    return () => {
      watched.looks.delete(look);
      if (watched.looks.size || this.all.get(board) !== watched) return;
      this.all.delete(board);
      if (this.bus.link?.connected) this.bus.link.unsubscribe([this.bus.topics.properties(board), this.bus.topics.values(board)]);
    };
  }

  // Takes a message; false: it is none of these.
  take(topic, payload, stored) {
    for (const [board, { standing, looks }] of this.all) {
      const isList = topic === this.bus.topics.properties(board);
      if (!isList && topic !== this.bus.topics.values(board)) continue;
      const known = this.bus.boards.get(board);
      const holder = known?.described ? known.session : '';
      const counts = isList ? standing.takeList(payload, board, holder) : standing.takeValues(payload, board, holder, this.now(), stored);
      const acts = counts && !isList ? standing.acts : [];
      if (counts) for (const look of [...looks]) this.bus.guard(`what is known of ${board}`, () => look(standing, acts));
      return true;
    }
    return false;
  }
}

module.exports = { Standing, Standings, UNKNOWN, requestsFor, textOf };
