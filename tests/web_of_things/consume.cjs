// SPDX-License-Identifier: Apache-2.0
// A consumer of things (node-wot): does what it is asked, one line of JSON each, and answers with a line.
//
//   node consume.cjs MODULES    {"read":[TD address, property]}, {"write":[.., property, value]}, {"invoke":[.., action]},
//                               {"observe":[.., property, number of values]}, {"validate":address}
const { createRequire } = require("node:module");
const { createInterface } = require("node:readline");
const [modules] = process.argv.slice(2);
const load = createRequire(modules + "/x.js");
const { Servient } = load("@node-wot/core");
const { HttpClientFactory } = load("@node-wot/binding-http");
const Ajv = load("ajv");
const formats = load("ajv-formats");

process.on("unhandledRejection", (error) => { console.error("unhandled", error); process.exit(3); });

const servient = new Servient();
servient.addClientFactory(new HttpClientFactory(null));
const validator = new Ajv({ strict: false, allErrors: true });
formats(validator);
const valid = validator.compile(load("wot-thing-description-types/schema/td-json-schema-validation.json"));

const limit = (promise, what) => Promise.race([promise, new Promise((_, reject) => setTimeout(() => reject(new Error(what + ": not within 15 s")), 15000))]);
const document = async (address) => (await fetch(address)).json();

async function main() {
  const wot = await servient.start();
  const things = new Map();
  const thing = async (address) => {
    if (!things.has(address)) things.set(address, await wot.consume(await document(address)));
    return things.get(address);
  };
  const several = (subscribe, count) => new Promise((resolve, reject) => {
    const values = [];
    subscribe(async (output) => {
      values.push(await output.value());
      if (values.length === count) resolve(values);
    }, reject).catch(reject);
  });
  const tasks = {
    validate: async (address) => { const ok = valid(await document(address)); return ok ? [] : valid.errors; },
    read: async ([address, name]) => (await (await thing(address)).readProperty(name)).value(),
    write: async ([address, name, value]) => { await (await thing(address)).writeProperty(name, value); return "written"; },
    invoke: async ([address, name]) => { await (await thing(address)).invokeAction(name); return "invoked"; },
    observe: async ([address, name, count]) => { const one = await thing(address); return several((next, failed) => one.observeProperty(name, next, failed), count); },
  };
  for await (const line of createInterface({ input: process.stdin })) {
    const [[task, argument]] = Object.entries(JSON.parse(line));
    const result = await limit(tasks[task](argument), task).then((value) => ({ task, value }), (error) => ({ task, error: String(error.message ?? error) }));
    process.stdout.write("=" + JSON.stringify(result) + "\n");
  }
  process.exit(0);
}
main();
