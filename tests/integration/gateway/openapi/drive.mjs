// SPDX-License-Identifier: Apache-2.0
// Drives every operation of the served document, each documented status included, and checks each answer against its
// schema. A status that is documented and not brought about here is a failure; so is an answer that is not documented.
//
//   node drive.mjs MODULES URL PHASE VIEWER ADMIN KIOSK    MODULES: the folder of node_modules; PHASE: of the cases below;
//                                                          then tokens
import { createRequire } from "node:module";
import { request } from "node:http";

const [modules, base, phase, viewer, admin, kiosk] = process.argv.slice(2);
const load = createRequire(modules + "/");
const { Validator } = await import(load.resolve("@seriousme/openapi-schema-validator"));
const Ajv = load("ajv/dist/2020.js").default;

function send(method, path, { headers = {}, body } = {}) {
  return new Promise((resolve, reject) => {
    const url = new URL(path, base);
    const text = body === undefined ? undefined : JSON.stringify(body);
    const all = { Authorization: `Bearer ${admin}`, ...(text === undefined ? {} : { "Content-Type": "application/json", "Content-Length": Buffer.byteLength(text) }), ...headers };
    for (const name of Object.keys(all)) if (all[name] === null) delete all[name];
    const out = request(url, { method, headers: all, agent: false });
    const done = (answer) => resolve({ status: answer.statusCode, headers: answer.headers, text: "" });
    out.on("upgrade", (answer, socket) => { socket.destroy(); done(answer); });
    out.on("response", (answer) => {
      if ((answer.headers["content-type"] ?? "").startsWith("text/event-stream")) {
        if (!method.startsWith("HOLD")) out.destroy();
        return done(answer);
      }
      let received = "";
      answer.on("data", (piece) => { received += piece; });
      answer.on("end", () => resolve({ status: answer.statusCode, headers: answer.headers, text: received }));
    });
    out.on("error", (error) => { error.code === "ECONNRESET" ? resolve({ status: 0, headers: {}, text: "" }) : reject(error); });
    out.end(text);
  });
}

const upgrade = { Upgrade: "websocket", Connection: "Upgrade", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==" };
const write = "/api/boards/uno1/services/servo/commands/write";
const post = (path, body = {}, headers = {}) => () => send("POST", path, { body, headers });
const values = "/api/boards/uno1/values";
const turned = (degrees) => ({ "servo/0/angle": degrees });
const angle = "/things/uno1/properties/servo-0-angle";
const put = (path, body, headers = {}) => () => send("PUT", path, { body, headers });
const get = (path, headers = {}) => () => send("GET", path, { headers });
const key = (text) => ({ "Idempotency-Key": text });

async function etag(path) {
  const first = await send("GET", path);
  return send("GET", path, { headers: { "If-None-Match": first.headers.etag } });
}
async function twice(path, one, other, id) {
  await send("POST", path, { body: one, headers: key(id) });
  return send("POST", path, { body: other, headers: key(id) });
}
// Many at a time: one after the other a busy machine may stay below what is allowed.
async function flood(path, body, method = "POST") {
  let answers = [];
  for (let i = 0; i < 100; ++i) {
    answers = await Promise.all(Array.from({ length: 20 }, () => send(method, path, { body })));
    const refused = answers.find((answer) => answer.status === 429);
    if (refused) return refused;
  }
  return answers.at(-1);
}
// All of them at once: what the first ones wait for has not come when the last ones ask.
async function crowd(ask) {
  const answers = await Promise.all(Array.from({ length: 70 }, ask));
  return answers.find((answer) => answer.status === 429) ?? answers.at(-1);
}
async function streams(path, headers = {}) {
  const held = [];
  let last;
  for (let i = 0; i < 70; ++i) {
    last = await new Promise((resolve) => {
      const out = request(new URL(path, base), { headers: { Authorization: `Bearer ${admin}`, ...headers }, agent: false });
      held.push(out);
      out.on("response", (answer) => resolve({ status: answer.statusCode, headers: answer.headers, answer }));
      out.on("upgrade", (answer, socket) => { held.push(socket); resolve({ status: 101, headers: answer.headers }); });
      out.on("error", () => {});
      out.end();
    });
    if (last.status === 429) break;
  }
  let text = "";
  if (last.answer && last.status === 429) for await (const piece of last.answer) text += piece;
  for (const each of held) each.destroy();
  await new Promise((resolve) => setTimeout(resolve, 300));
  return { status: last.status, headers: last.headers, text };
}

const slider = (id, board, servo) => ({ id, kind: "slider", board, property: `servo/${servo}/angle` });
const lab = { title: "Lab", widgets: [{ id: "plot", kind: "plot", board: "uno1", property: "distance/0", span: "day" }, slider("turn", "uno1", 0), slider("away", "lost", 0), slider("frost", "frozen", 0)] };
const cold = { title: "Cold", widgets: [slider("frost", "frozen", 0), { id: "halt", kind: "stop" }] };
const calm = { title: "Calm", widgets: [slider("turn", "uno1", 0), { id: "halt", kind: "stop" }] };
const calmed = async () => {
  await make("calm", calm);
  const answer = await post("/api/dashboards/calm/widgets/halt")();
  await post("/api/boards/uno1/resume")();
  return answer;
};
const make = (name, dashboard) => send("PUT", `/api/dashboards/${name}`, { body: dashboard, headers: { "If-Match": "*" } });

const kept = "/api/boards/uno1/values/kept?property=distance/0";
const widget_kept = "/api/dashboards/lab/widgets/plot/kept";
const links = "/api/boards/uno1/links";
const rule = (name) => ({ set: { name, from: "uno1/distance/0", when: "follows", to: "servo/0/angle" } });

// A lesson on uno1, opened where there is none.
async function lesson() {
  const { items } = JSON.parse((await send("GET", "/api/lessons")).text);
  return items[0] ?? JSON.parse((await send("POST", "/api/lessons", { body: { boards: ["uno1"] } })).text);
}
const join = (code) => send("POST", "/api/join", { body: { code }, headers: { Authorization: null } });
const in_lesson = (method, more, options) => async () => send(method, `/api/lessons/${(await lesson()).id}${more}`, options);

// How to bring each status about. What holds for all operations is made below.
const cases = {
  up: {
    listBoards: { 200: get("/api/boards?limit=1&full=true"), 304: () => etag("/api/boards") },
    getBoard: { 200: get("/api/boards/uno1"), 304: () => etag("/api/boards/uno1"), 404: get("/api/boards/none") },
    forgetBoard: { 200: () => send("DELETE", "/api/boards/gone"), 404: () => send("DELETE", "/api/boards/none"), 409: () => send("DELETE", "/api/boards/uno1") },
    getKeptValues: { 200: get(`${kept}&points=10`), 400: get(`${kept}&from=x`), 404: get("/api/boards/none/values/kept?property=distance/0") },
    getBoardHistory: { 200: get("/api/boards/uno1/history?limit=10"), 404: get("/api/boards/none/history") },
    getHistory: { 200: get("/api/history?limit=10") },
    listServices: { 200: get("/api/services?kind=servo"), 304: () => etag("/api/services") },
    getService: { 200: get("/api/boards/uno1/services/servo"), 404: get("/api/boards/uno1/services/none") },
    getValue: { 200: get("/api/boards/uno1/services/distance/value?wait=0"), 404: get("/api/boards/uno1/services/none/value") },
    getValues: { 200: get("/api/boards/uno1/services/distance/values"), 404: get("/api/boards/none/services/none/values") },
    sendCommand: {
      200: post(write, [0, 90]), 400: post(write, [0, 900]), 404: post("/api/boards/uno1/services/servo/commands/none"),
      409: () => twice(write, [0, 10], [0, 11], "again"), 422: post(write, { servo: 9, angle: 90 }),
      503: post("/api/boards/lost/services/servo/commands/write", [0, 90]), 504: post("/api/boards/mute/services/S1/commands/raw?deadline_ms=50", "x"),
    },
    sendRaw: {
      200: post("/api/boards/uno1/raw", { lines: ["I,P,13,3"] }), 400: post("/api/boards/uno1/raw", {}), 404: post("/api/boards/none/raw", { lines: ["x"] }),
      409: () => twice("/api/boards/uno1/raw", { lines: ["I,P,13,3"] }, { lines: ["I,P,12,3"] }, "raw"), 422: post("/api/boards/uno1/raw", { lines: ["I,d,99,1"] }),
      503: post("/api/boards/lost/raw", { lines: ["x"] }), 504: post("/api/boards/mute/raw?deadline_ms=50", { lines: ["x"] }),
    },
    labelBoard: {
      200: post("/api/boards/uno1/labels", { labels: { room: "lab" } }), 400: post("/api/boards/uno1/labels", { rooms: {} }), 404: post("/api/boards/none/labels", { labels: {} }),
      409: () => twice("/api/boards/uno1/labels", { labels: { room: "lab" } }, { labels: { room: "hall" } }, "label"),
      503: post("/api/boards/lost/labels", { labels: { room: "lab" } }), 504: post("/api/boards/mute/labels?deadline_ms=50", { labels: { room: "lab" } }),
    },
    getBoardLinks: { 200: get("/api/boards/uno1/links"), 404: get("/api/boards/none/links") },
    changeBoardLink: {
      200: post(links, rule("a")), 400: post(links, {}), 404: post("/api/boards/none/links", rule("a")), 409: () => twice(links, rule("b"), rule("c"), "link"),
      503: post("/api/boards/lost/links", rule("a")), 504: post("/api/boards/mute/links?deadline_ms=50", rule("a")),
    },
    loadBoard: {
      400: post("/api/boards/uno1/load", { file: "x" }), 404: post("/api/boards/none/load"), 409: post("/api/boards/uno1/load"),
      503: post("/api/boards/lost/load"), 504: post("/api/boards/mute/load?deadline_ms=50"),
    },
    getCommand: { 200: async () => { await post(write, [0, 20], key("known"))(); return get("/api/commands/known")(); }, 404: get("/api/commands/none") },
    renewCommand: {
      200: async () => { await post("/api/boards/uno1/services/io/commands/write?hold_ms=5000", [13, 1], key("held"))(); return post("/api/commands/held/renew")(); },
      404: post("/api/commands/none/renew"),
      409: async () => { await post(write, [0, 30], key("plain"))(); return post("/api/commands/plain/renew")(); },
      504: async () => { await post("/api/boards/mute/services/S1/commands/raw?deadline_ms=50", "y", key("mute"))(); return post("/api/commands/mute/renew")(); },
    },
    stopBoard: { 200: post("/api/boards/uno1/stop?once=true"), 207: post("/api/boards/frozen/stop"), 404: post("/api/boards/none/stop") },
    stopAll: { 207: post("/api/stop?once=true") },
    resumeBoard: { 200: post("/api/boards/uno1/resume"), 207: post("/api/boards/frozen/resume"), 404: post("/api/boards/none/resume") },
    resumeAll: { 207: post("/api/resume") },
    listModels: { 200: get("/api/models") },
    getModel: { 200: get("/api/models/servo"), 404: get("/api/models/none") },
    streamEvents: { 200: get("/api/events"), 429: () => streams("/api/events") },
    streamValues: { 200: get("/api/boards/uno1/services/distance/stream?max_hz=5"), 404: get("/api/boards/none/services/none/stream"), 429: () => streams("/api/boards/uno1/services/distance/stream") },
    lendBoard: { 404: get("/api/cable", upgrade), 426: get("/api/cable") },
    stream: { 101: get("/api/stream", upgrade), 426: get("/api/stream"), 429: () => streams("/api/stream", upgrade) },
    getStatus: { 200: get("/api/status") },
    endSession: { 204: () => send("DELETE", "/api/session") },
    getOpenapi: { 200: get("/api/openapi.json") },
    getMetrics: { 200: get("/metrics"), 403: get("/metrics", { Authorization: `Bearer ${kiosk}` }) },
    getHealth: { 200: get("/healthz") },
    getReady: { 200: get("/readyz") },
    makeCode: { 200: post("/api/codes") },
    getProperties: { 200: get("/api/boards/uno1/properties"), 404: get("/api/boards/none/properties") },
    getBoardValues: { 200: get("/api/boards/uno1/values?ids=distance/0"), 404: get("/api/boards/uno1/values?ids=none") },
    streamBoardValues: { 200: get("/api/boards/uno1/values/stream"), 404: get("/api/boards/none/values/stream"), 429: () => streams("/api/boards/uno1/values/stream") },
    listDashboards: { 200: get("/api/dashboards") },
    getDashboard: { 200: async () => { await make("lab", lab); return get("/api/dashboards/lab")(); }, 404: get("/api/dashboards/none") },
    putDashboard: {
      200: put("/api/dashboards/lab", lab, { "If-Match": "*" }), 201: put("/api/dashboards/other", lab), 400: put("/api/dashboards/lab", { widgets: [{ kind: "lamb" }] }),
      412: put("/api/dashboards/lab", lab, { "If-Match": '"0"' }), 428: put("/api/dashboards/lab", lab),
    },
    useWidget: {
      200: calmed, 204: post("/api/dashboards/lab/widgets/turn", { value: 90 }), 207: async () => { await make("cold", cold); return post("/api/dashboards/cold/widgets/halt")(); }, 400: post("/api/dashboards/lab/widgets/turn", { value: 900 }),
      404: post("/api/dashboards/lab/widgets/none", { value: 1 }),
      409: () => twice("/api/dashboards/lab/widgets/turn", { value: 10 }, { value: 11 }, "turned"),
      503: post("/api/dashboards/lab/widgets/away", { value: 90 }), 504: post("/api/dashboards/lab/widgets/frost", { value: 90 }),
    },
    getWidgetKept: { 200: get(widget_kept), 400: get(`${widget_kept}?from=x`), 404: get("/api/dashboards/lab/widgets/none/kept") },
    makeLink: { 201: post("/api/dashboards/lab/links", { name: "hall", until: "1h" }), 404: post("/api/dashboards/none/links") },
    deleteLink: { 204: () => send("DELETE", "/api/dashboards/lab/links/hall"), 404: () => send("DELETE", "/api/dashboards/lab/links/none") },
    deleteDashboard: {
      204: async () => { await make("brief", lab); return send("DELETE", "/api/dashboards/brief"); }, 404: () => send("DELETE", "/api/dashboards/none"),
      412: async () => { await make("lab", lab); return send("DELETE", "/api/dashboards/lab", { headers: { "If-Match": '"0"' } }); },
    },
    listLessons: { 200: get("/api/lessons") },
    openLesson: {
      201: async () => { await in_lesson("DELETE", "")(); return post("/api/lessons", { boards: ["uno1"] })(); },
      404: post("/api/lessons", { boards: ["none"] }), 409: post("/api/lessons", { boards: ["uno1"] }),
    },
    getLesson: { 200: in_lesson("GET", ""), 404: get("/api/lessons/none") },
    takeOver: { 200: in_lesson("POST", "/take", { body: { board: "uno1" } }), 404: post("/api/lessons/none/take", { board: "uno1" }) },
    endLesson: { 204: in_lesson("DELETE", ""), 404: () => send("DELETE", "/api/lessons/none") },
    joinLesson: { 200: async () => join((await lesson()).code), 404: () => join("CCCCCC"), 409: async () => join((await lesson()).code) },
    getDirectory: { 200: get("/.well-known/wot") },
    listThings: { 200: get("/things?limit=10") },
    getThing: { 200: get("/things/uno1"), 404: get("/things/none") },
    readProperties: { 200: get("/things/uno1/properties"), 404: get("/things/none/properties") },
    readProperty: { 200: get("/things/uno1/properties/board-state"), 404: get("/things/uno1/properties/none") },
    putBoardValue: {
      204: put(values, turned(90)), 400: put(values, turned(900)), 404: put(values, { none: 1 }),
      409: async () => { await put(values, turned(10), key("turned"))(); return put(values, turned(11), key("turned"))(); },
      503: put("/api/boards/lost/values", turned(90)), 504: put("/api/boards/frozen/values?deadline_ms=50", turned(90)),
    },
    writeProperty: {
      204: put(angle, 90), 400: put(angle, 900), 404: put("/things/uno1/properties/none", 1),
      409: async () => { await put(angle, 10, key("set"))(); return put(angle, 11, key("set"))(); },
      503: put("/things/lost/properties/servo-0-angle", 90), 504: put("/things/frozen/properties/servo-0-angle?deadline_ms=50", 90),
    },
    observeProperty: { 200: get("/things/uno1/properties/distance-0/stream"), 404: get("/things/uno1/properties/none/stream"), 429: () => streams("/things/uno1/properties/distance-0/stream") },
    invokeAction: { 404: post("/things/uno1/actions/none") },
    streamThings: { 200: get("/events"), 429: () => streams("/events") },
    streamThingsOfType: { 200: get("/events/thing_deleted"), 404: get("/events/none"), 429: () => streams("/events/thing_created") },
  },
  flood: {
    sendCommand: { 429: () => flood(write, [0, 900 / 10]) },
    sendRaw: { 429: () => flood("/api/boards/uno1/raw", { lines: ["I,P,13,3"] }) },
    labelBoard: { 429: () => flood("/api/boards/uno1/labels", { labels: { room: "lab" } }) },
    changeBoardLink: { 429: () => flood(links, rule("a")) },
    loadBoard: { 429: () => flood("/api/boards/uno1/load", { firmware: "AsipServices" }) },
    makeCode: { 429: () => flood("/api/codes", {}) },
    joinLesson: { 429: () => flood("/api/join", { code: "CCCCCC" }) },
    useWidget: { 429: () => flood("/api/dashboards/lab/widgets/turn", { value: 90 }) },
    writeProperty: { 429: () => flood(angle, 90, "PUT") },
    putBoardValue: { 429: () => flood(values, turned(90), "PUT") },
  },
  // The registry is stopped, and one client may keep 256 kB.
  stalled: {
    forgetBoard: { 429: () => crowd(() => send("DELETE", "/api/boards/lost")) },
    getKeptValues: { 429: () => crowd(get(kept)) },
    getWidgetKept: { 429: () => crowd(get(widget_kept)) },
    getBoardHistory: { 429: () => crowd(get("/api/boards/uno1/history")) },
    getHistory: { 429: () => crowd(get("/api/history")) },
    getValue: { 429: () => crowd(get("/api/boards/uno1/services/servo/value?wait=2")) },
  },
  without: {
    getMetrics: { 404: get("/metrics") },
    getDirectory: { 404: get("/.well-known/wot") },
    listThings: { 404: get("/things") },
    streamThings: { 404: get("/events") },
  },
  quiet: { stopAll: { 200: post("/api/stop?once=true") }, resumeAll: { 200: post("/api/resume") } },
  down: {
    forgetBoard: { 503: () => send("DELETE", "/api/boards/uno1") },
    getKeptValues: { 503: get(kept) },
    getWidgetKept: { 503: get(widget_kept) },
    getBoardHistory: { 503: get("/api/boards/uno1/history") },
    getHistory: { 503: get("/api/history") },
    getValue: { 503: get("/api/boards/uno1/services/distance/value?wait=1") },
    renewCommand: { 503: post("/api/commands/none/renew") },
    putDashboard: { 503: put("/api/dashboards/new", lab) },
    deleteDashboard: { 503: () => send("DELETE", "/api/dashboards/lab") },
    openLesson: { 503: post("/api/lessons", { boards: ["uno1"] }) },
    makeLink: { 503: post("/api/dashboards/lab/links") },
    deleteLink: { 503: () => send("DELETE", "/api/dashboards/lab/links/hall") },
    stopBoard: { 503: post("/api/boards/uno1/stop") },
    stopAll: { 503: post("/api/stop") },
    resumeBoard: { 503: post("/api/boards/uno1/resume") },
    resumeAll: { 503: post("/api/resume") },
    getBoardLinks: { 503: get("/api/boards/uno1/links") },
    streamEvents: { 503: get("/api/events") },
    streamValues: { 503: get("/api/boards/uno1/services/distance/stream") },
    streamBoardValues: { 503: get("/api/boards/uno1/values/stream") },
    getReady: { 503: get("/readyz") },
    writeProperty: { 503: put(angle, 90) },
    putBoardValue: { 503: put(values, turned(90)) },
    observeProperty: { 503: get("/things/uno1/properties/distance-0/stream") },
    streamThings: { 503: get("/events") },
    streamThingsOfType: { 503: get("/events/thing_created") },
  },
  nohistory: { getKeptValues: { 404: get(kept) }, getBoardHistory: { 404: get("/api/boards/uno1/history") }, getHistory: { 404: get("/api/history") } },
};

// What no board here does: api_things_test.cpp, tests/box and tests/cable bring it about. What a second editor or a gateway that has just begun
// meets: api_dashboards_test.cpp.
const elsewhere = { lendBoard: [101, 429], loadBoard: [200], writeProperty: [422], putBoardValue: [422], useWidget: [422], invokeAction: [204, 409, 422, 429, 503, 504],
  getDashboard: [503], putDashboard: [409], deleteDashboard: [409], makeLink: [409], deleteLink: [409] };

const document = JSON.parse((await send("GET", "/api/openapi.json")).text);
let failures = 0;
const fail = (text) => { console.error(text); ++failures; };

const checked = await new Validator().validate(structuredClone(document));
if (!checked.valid) fail("not OpenAPI 3.1: " + JSON.stringify(checked.errors, null, 1));

const ajv = new Ajv({ strict: false });
ajv.addSchema({ $id: "document", components: document.components });

function sample(path) {
  return path.replace("/things/{id}", "/things/uno1").replace("{property}", "servo-0-angle").replace("{action}", "none").replace("{type}", "thing_created").replace("{dashboard}", "lab").replace("{widget}", "turn").replace("{link}", "none").replace("{lesson}", "none").replace("{board}", "uno1").replace("{service}", "servo").replace("{command}", "write").replace("{name}", "servo").replace("{id}", "known");
}
function common(method, path, operation) {
  const body = method === "POST" || method === "PUT" ? { body: {} } : {};
  return {
    400: () => send(method, sample(path) + "?nonsense=1", body),
    401: () => send(method, sample(path), { ...body, headers: { Authorization: "Bearer wrong" } }),
    403: () => send(method, sample(path), { ...body, headers: { Authorization: `Bearer ${viewer}`, ...(operation.operationId === "makeCode" || operation.operationId === "joinLesson" || operation.operationId === "endSession" ? { Origin: "http://evil.example" } : {}) } }),
    415: () => send(method, sample(path), { headers: { "Content-Type": "text/plain" }, body: {} }),
    421: () => send(method, sample(path), { ...body, headers: { Host: "evil.example" } }),
  };
}

const resolve = (object) => (object.$ref ? object.$ref.split("/").slice(1).reduce((at, name) => at[name], document) : object);

for (const [path, item] of Object.entries(document.paths)) {
  for (const [method, operation] of Object.entries(item)) {
    const id = operation.operationId;
    const wanted = Object.keys(operation.responses).map(Number);
    for (const status of wanted) {
      const somewhere = Object.values(cases).some((each) => each[id]?.[status]) || [400, 401, 403, 415, 421].includes(status);
      if (!somewhere && !elsewhere[id]?.includes(status)) fail(`${id} documents ${status}, and nothing here brings it about`);
      const run = cases[phase]?.[id]?.[status] ?? (phase === "up" ? common(method.toUpperCase(), path, operation)[status] : undefined);
      if (!run || (phase === "up" && !cases.up[id]?.[status] && ![400, 401, 403, 415, 421].includes(status))) continue;
      const answer = await run();
      if (answer.status !== status) { fail(`${id}: ${answer.status} instead of ${status}: ${answer.text}`); continue; }
      const content = resolve(operation.responses[status]).content;
      if (!content) continue;
      const [type, media] = Object.entries(content)[0];
      const served = answer.headers["content-type"] ?? "";
      if (served.split(";")[0] !== type.split(";")[0]) { fail(`${id} ${status}: ${served} instead of ${type}`); continue; }
      if (!type.includes("json")) continue;
      const valid = ajv.compile({ $ref: "document" + media.schema.$ref });
      if (!valid(JSON.parse(answer.text))) fail(`${id} ${status}: ${ajv.errorsText(valid.errors)}: ${answer.text.slice(0, 300)}`);
    }
  }
}
for (const [name, operations] of Object.entries(cases)) {
  for (const [id, statuses] of Object.entries(operations)) {
    const known = Object.values(document.paths).flatMap((item) => Object.values(item)).find((each) => each.operationId === id);
    for (const status of Object.keys(statuses)) if (!known?.responses[status]) fail(`${id} answers ${status} (${name}), and does not document it`);
  }
}
process.exit(failures === 0 ? 0 : 1);
