// SPDX-License-Identifier: Apache-2.0
// What services take and tell: the model that a board carries, else the standard one that it refers to (`servo@1`), of this package's
// copies or of a registry. The commands and values of one version are the same everywhere, so any copy will do.
'use strict';

const { existsSync, readFileSync, readdirSync } = require('node:fs');
const { join } = require('node:path');
const { isObject } = require('./protocol');

// The models of a folder, by name, without their examples.
function readStandard(folder) {
  const files = readdirSync(folder).filter((file) => file.endsWith('.json') && file !== 'schema.json').sort();
  return Object.fromEntries(files.map((file) => {
    const { examples, ...model } = JSON.parse(readFileSync(typeof folder === 'string' ? join(folder, file) : new URL(file, folder)));
    return [model.name, model];
  }));
}

// In a clone they are those of services/, also where a Node-RED has a link to it; a copy has them in one file.
const services = join(__dirname, '..', '..', 'services');
const copied = join(__dirname, 'models.json');
const inClone = existsSync(join(services, 'schema.json'));
if (!inClone && !existsSync(copied)) throw new Error(`${copied} is missing: npm was told to run no scripts when it copied this folder`);
const standard = inClone ? readStandard(services) : JSON.parse(readFileSync(copied));

const refOf = (model) => `${model.name}@${model.version ?? 1}`;
const own = new Map(Object.values(standard).map((model) => [refOf(model), model]));

class Models {
  constructor() {
    this.told = new Map(); // by reference: from a registry
    this.asked = new Set();
  }

  // The model of a service of a description; undefined where none is known.
  of(service) {
    if (isObject(service?.model)) return service.model;
    return own.get(service?.model) || this.told.get(service?.model);
  }

  // The names of models to ask a registry for: those of this description that are not known, each once.
  unknown(description) {
    const names = new Set();
    for (const service of description.services) {
      if (typeof service?.model !== 'string' || this.of(service) || this.asked.has(service.model) || this.asked.size >= 1024) continue;
      this.asked.add(service.model);
      names.add(service.model.split('@')[0]);
    }
    return [...names];
  }

  // Takes the items of a registry's answer.
  take(items) {
    for (const model of Array.isArray(items) ? items : []) if (isObject(model) && typeof model.name === 'string' && Number.isInteger(model.version ?? 1) && this.told.size < 4096) this.told.set(refOf(model), model);
  }
}

const eventsOf = (model) => (isObject(model?.events) ? Object.entries(model.events) : []);

// The unit of an event's first field; undefined: it has none.
const unitOf = (model, event) => {
  const unit = eventsOf(model).find(([, one]) => one?.name === event)?.[1].fields?.[0]?.unit;
  return typeof unit === 'string' ? unit : undefined;
};

// The command without arguments by which the board tells this event (the first one where none is named).
function askerOf(model, event) {
  const tag = eventsOf(model).find(([, one]) => !event || one?.name === event)?.[0];
  if (!tag) return undefined;
  return Object.entries(isObject(model?.commands) ? model.commands : {}).find(([, one]) => one?.answer === tag && !(one.args || []).length)?.[0];
}

// The commands of a model as a form shows them. What is counted is not asked.
const commandsOf = (model) => Object.entries(isObject(model?.commands) ? model.commands : {}).map(([name, one]) => ({
  name,
  title: typeof one?.title === 'string' ? one.title : '',
  args: (Array.isArray(one?.args) ? one.args : []).filter((arg) => isObject(arg) && arg.type !== 'count').map(({ name: arg, title, type, unit, min, max, names, items, max_length: most }) => ({
    name: arg, title, type, unit, min, max, names: isObject(names) ? Object.keys(names) : undefined, items: Array.isArray(items) ? items.map((item) => item?.name) : undefined, most,
  })),
}));

module.exports = { readStandard, Models, askerOf, commandsOf, unitOf };
