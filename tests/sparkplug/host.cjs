// SPDX-License-Identifier: Apache-2.0
// A Sparkplug host made of Eclipse Tahu's JavaScript payload library: decodes what is published, checks its rules, and commands.
//
//   node host.cjs MODULES BROKER [OPTIONS]   OPTIONS: JSON for mqtt.js. Asked by lines of JSON, each is answered with a line:
//                                            {"seen":0}, {"get":[device, metric]}, {"faults":0}, {"command":[device, metric, type, value]},
//                                            {"rebirth":0}, {"publish":[topic, text]}
const { createRequire } = require("node:module");
const { createInterface } = require("node:readline");
const { readFileSync } = require("node:fs");
const [modules, broker, more] = process.argv.slice(2);
const load = createRequire(modules + "/x.js");
const sparkplug = load("sparkplug-payload").get("spBv1.0");
const mqtt = load("mqtt");

const group = "spBv1.0/plant";
const faults = [];
const seen = { node: false, births: 0, messages: 0, bdSeqs: [], deaths: [], devices: {}, deviceDeaths: 0 };
const aliases = new Map();  // device -> alias -> metric
let seq = null;

const number = (value) => (value === undefined || value === null ? null : Number(value));

function heard(topic, bytes) {
  const [, , kind, , device] = topic.split("/");
  if (kind === "NCMD" || kind === "DCMD") return;
  const payload = sparkplug.decodePayload(bytes);
  if (!payload.timestamp) faults.push(`${topic}: no timestamp`);
  const bdSeq = () => number(payload.metrics.find((each) => each.name === "bdSeq")?.value);
  if (kind === "NDEATH") {
    if (payload.seq !== undefined && payload.seq !== null) faults.push(`${topic}: a seq`);
    seen.deaths.push(bdSeq());
    if (bdSeq() === seen.bdSeqs.at(-1)) seen.node = false;
    return;
  }
  const expected = kind === "NBIRTH" ? 0 : (seq + 1) % 256;
  if (seq === null && kind !== "NBIRTH") return;
  seq = number(payload.seq);
  if (seq !== expected) faults.push(`${topic}: seq ${seq} instead of ${expected}`);
  ++seen.messages;
  if (kind === "NBIRTH") {
    if (!payload.metrics.some((each) => each.name === "Node Control/Rebirth" && each.value === false)) faults.push(`${topic}: no rebirth`);
    seen.node = true;
    ++seen.births;
    seen.bdSeqs.push(bdSeq());
    seen.devices = {};
    aliases.clear();
  } else if (kind === "DBIRTH") {
    aliases.set(device, new Map());
    seen.devices[device] = {};
    for (const each of payload.metrics) {
      if (!each.name || each.alias === undefined || !each.timestamp) faults.push(`${topic}: ${JSON.stringify(each)}`);
      aliases.get(device).set(number(each.alias), each.name);
      take(device, each.name, each);
    }
  } else if (kind === "DDATA") {
    for (const each of payload.metrics) {
      const name = aliases.get(device)?.get(number(each.alias));
      if (each.name || !name) faults.push(`${topic}: ${JSON.stringify(each)}`);
      else take(device, name, each);
    }
  } else if (kind === "DDEATH") {
    ++seen.deviceDeaths;
    delete seen.devices[device];
  }
}

function take(device, name, metric) {
  const value = typeof metric.value === "object" && metric.value !== null ? number(metric.value) : metric.value;
  const properties = Object.fromEntries(Object.entries(metric.properties ?? {}).map(([key, each]) => [key, each.value]));
  const before = seen.devices[device][name]?.properties ?? {};
  seen.devices[device][name] = { type: metric.type, value: value ?? null, properties: { ...before, ...properties } };
}

const options = more ? JSON.parse(more) : {};
if (options.caFile) options.ca = readFileSync(options.caFile);
const client = mqtt.connect(broker, options);
client.subscribe(`${group}/#`);
client.on("message", (topic, bytes) => {
  try {
    heard(topic, bytes);
  } catch (error) {
    faults.push(`${topic}: ${error.stack}`);
  }
});
client.on("error", (error) => faults.push(String(error)));

const encoded = (name, type, value) => sparkplug.encodePayload({ timestamp: Date.now(), metrics: [{ name, type, value, timestamp: Date.now() }] });
const tasks = {
  seen: () => ({ ...seen, devices: Object.keys(seen.devices).sort() }),
  get: ([device, name]) => seen.devices[device]?.[name] ?? null,
  faults: () => faults,
  command: ([device, name, type, value]) => { client.publish(`${group}/DCMD/asip/${device}`, encoded(name, type, value)); return true; },
  rebirth: () => { client.publish(`${group}/NCMD/asip`, encoded("Node Control/Rebirth", "Boolean", true)); return true; },
  publish: ([topic, text]) => { client.publish(topic, text); return true; },
};

async function main() {
  for await (const line of createInterface({ input: process.stdin })) {
    const [[task, argument]] = Object.entries(JSON.parse(line));
    try {
      process.stdout.write("=" + JSON.stringify({ value: tasks[task](argument) }) + "\n");
    } catch (error) {
      process.stdout.write("=" + JSON.stringify({ error: String(error.stack) }) + "\n");
    }
  }
  process.exit(0);
}
main();
