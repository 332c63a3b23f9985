// SPDX-License-Identifier: Apache-2.0
// A Homie controller (node-homie): finds devices, checks their descriptions and values, sets properties.
//
//   node control.cjs MODULES BROKER    asked by lines of JSON, each is answered with a line: {"devices":0}, {"faults":0},
//                                      {"get":[device, node, property]}, {"set":[.., value]}, {"log":0},
//                                      {"publish":[topic, payload]}, which the controller itself would not
const { createRequire } = require("node:module");
const { createInterface } = require("node:readline");
const [modules, broker] = process.argv.slice(2);
const load = createRequire(modules + "/x.js");
const { DeviceDiscovery, DeviceDescriptionSchema } = load("node-homie");
const { validateHomieValue } = require(modules + "/node_modules/node-homie/lib/cjs/util/homie-validation.func.js");
const { Validator } = load("jsonschema");
const mqtt = load("mqtt");

const options = { url: broker };
const devices = new Map();
const logs = [];
const faults = [];
const types = new Map();  // topic of a property -> its description

async function main() {
  // What stands on the broker, beside what the controller makes of it.
  const raw = mqtt.connect(broker);
  raw.subscribe("homie/5/#");
  const values = new Map();
  raw.on("message", (topic, payload) => {
    const text = payload.toString();
    if (topic.endsWith("/$description") && text) {
      const description = JSON.parse(text);
      const result = new Validator().validate(description, DeviceDescriptionSchema);
      for (const error of result.errors) faults.push(`${topic}: ${error.stack}`);
      for (const [node, each] of Object.entries(description.nodes ?? {}))
        for (const [property, about] of Object.entries(each.properties ?? {}))
          types.set(topic.replace("$description", `${node}/${property}`), about);
    } else {
      values.set(topic, text);
    }
  });
  const discovery = new DeviceDiscovery(options);
  discovery.events$.subscribe(async (event) => {
    const id = event.deviceId ?? event.id;
    if (event.type === "add" && !devices.has(id)) {
      const device = event.makeDevice();
      devices.set(id, device);
      device.logEvent$.subscribe((entry) => logs.push(entry));
      await device.onInit();
    } else if (event.type === "remove") {
      devices.delete(id);
    }
  });
  await discovery.onInit();
  const property = ([device, node, name]) => devices.get(device)?.get(node)?.get(name);
  const tasks = {
    devices: () => Object.fromEntries([...devices].map(([id, device]) => [id, device.state])),
    faults: () => {
      for (const [topic, about] of types) {
        const text = values.get(topic);
        if (text && !validateHomieValue(text, about.datatype, about.format)) faults.push(`${topic}: ${text} is no ${about.datatype} ${about.format}`);
      }
      return faults;
    },
    get: (which) => { const found = property(which); return found ? { value: found.value ?? null, target: found.target ?? null, name: found.name } : null; },
    set: async ([device, node, name, value]) => { await new Promise((resolve, reject) => property([device, node, name]).setCommand$(value).subscribe({ error: reject, complete: resolve, next: resolve })); return true; },
    publish: ([topic, payload]) => { raw.publish(topic, payload); return true; },
    log: () => logs,
    topics: () => [...values.keys()].filter((topic) => values.get(topic) !== ""),
  };
  for await (const line of createInterface({ input: process.stdin })) {
    const [[task, argument]] = Object.entries(JSON.parse(line));
    try {
      process.stdout.write("=" + JSON.stringify({ value: await tasks[task](argument) }) + "\n");
    } catch (error) {
      process.stdout.write("=" + JSON.stringify({ error: String(error.stack) }) + "\n");
    }
  }
  process.exit(0);
}
main();
