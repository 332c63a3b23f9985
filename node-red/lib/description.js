// SPDX-License-Identifier: Apache-2.0
// What a `$description` must be before anything is believed of it: anybody may publish anything. Pure. The bounds are those of
// asip/catalogue and asip/model.
'use strict';

const { isObject, validBoard, validName } = require('./protocol');

const STATES = ['online', 'sleeping', 'updating', 'offline', 'lost'];
const DEFAULT_LEASE = 60;
const MAX_LEASE = 86400;

const whole = (value, most = Number.MAX_SAFE_INTEGER) => Number.isSafeInteger(value) && value >= 0 && value <= most;
const member = (object, name, fallback) => (Object.hasOwn(object, name) ? object[name] : fallback);
const isText = (value, most = 256) => typeof value === 'string' && value.length <= most;

function isService(one) {
  const model = member(one, 'model', {});
  return (isObject(model) || isText(model)) && isText(member(one, 'title', '')) && member(one, 'id', '-').length === 1 && isText(member(one, 'id', '-'))
    && ['count', 'period'].every((name) => whole(member(one, name, 0), 2 ** 31 - 1));
}

function areServices(services) {
  if (!Array.isArray(services) || services.length > 64 || !services.every(isObject)) return false;
  const names = services.map((one) => member(one, 'name'));
  return names.every(validName) && new Set(names).size === names.length && services.every(isService);
}

const areTexts = (value, most, isKey) => isObject(value) && Object.keys(value).length <= most
  && Object.entries(value).every(([key, text]) => isKey(key) && isText(text, 63) && Buffer.byteLength(text) <= 63);
const isLabel = (key) => /^[A-Za-z0-9]([A-Za-z0-9._-]{0,61}[A-Za-z0-9])?$/.test(key);
const isPin = (key) => /^(0|[1-9][0-9]{0,2})$/.test(key) && Number(key) < 256;

function areNamed(document) {
  const names = member(document, 'names', {});
  return isObject(names) && areTexts(member(document, 'labels', {}), 32, isLabel) && areTexts(member(names, 'services', {}), 64, validName)
    && areTexts(member(names, 'pins', {}), 64, isPin);
}

function isState(state) {
  const age = isObject(state) ? member(state, 'age', 0) : undefined;
  return typeof age === 'number' && age >= 0 && age <= 1e9 && STATES.includes(member(state, 'is')) && typeof member(state, 'reason', '') === 'string';
}

// The document with `lease` as it counts, and `labels`; null where it is no description of this board.
function readDescription(document, board) {
  if (!isObject(document) || member(document, 'board') !== board || !validBoard(board)) return null;
  const lease = member(document, 'lease', 0);
  if (!isText(member(document, 'session'), 64) || document.session === '' || !whole(member(document, 'seq')) || !whole(lease)) return null;
  if (!['firmware', 'link', 'agent', 'pins', 'on_demand', 'stopped'].every((name) => isObject(member(document, name, {})))) return null;
  if (!areServices(member(document, 'services')) || !areNamed(document) || (Object.hasOwn(document, 'state') && !isState(document.state))) return null;
  return { ...document, labels: member(document, 'labels', {}), lease: Math.min(lease, MAX_LEASE) || DEFAULT_LEASE };
}

module.exports = { STATES, DEFAULT_LEASE, readDescription };
