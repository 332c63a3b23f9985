// SPDX-License-Identifier: Apache-2.0
// A value of each board that is seen in the table. Only of the rows on the screen: each of them is asked of its board.
import { value_service } from "../core/catalogue.js";
import { numbers_of } from "../core/series.js";
import { with_unit } from "../core/text.js";
import { bus, path_of, request } from "../net/bus.js";

const kHz = 2;
const kMaxRows = 80;
const kSettleMs = 250; // rows that pass while the user scrolls are not asked

let models; // name -> model, or undefined while it is not known; a promise of the names that the gateway has
async function model_of(name) {
  models ??= request("api/models").then((answer) => new Map(answer.items.map((item) => [item.name, undefined])), () => new Map());
  const known = await models;
  if (known.has(name)) known.set(name, known.get(name) ?? request(path_of("models", name)).catch(() => undefined));
  return known.get(name);
}

/// The first service of a board that measures something by itself.
async function first_sensor(services) {
  for (const service of services) {
    if (service === "io") continue;
    const model = await model_of(service);
    if (model?.commands?.report && model.events) return service;
  }
  return undefined;
}

export class RowValues {
  /// `changed` is called when a text is another one.
  constructor(changed) {
    this.changed = changed;
    this.followed = new Map(); // board -> {service, text, end}
  }

  text(board) { return this.followed.get(board)?.text ?? ""; }

  /// The rows that are drawn, and of which service a value is wanted: "" the first sensor, "-" none.
  want(rows, service) {
    this.wanted = { rows: rows.slice(0, kMaxRows), service };
    this.timer ??= setTimeout(() => {
      this.timer = undefined;
      this.follow();
    }, kSettleMs);
  }

  async follow() {
    const { rows, service } = this.wanted ?? {};
    if (!rows || document.hidden) return this.forget(() => true);
    const chosen = new Map();
    for (const row of rows) {
      const wanted = value_service(row, service);
      const name = wanted === "" ? await first_sensor(row.services) : wanted;
      if (name) chosen.set(row.name, name);
    }
    if (this.wanted?.rows !== rows) return; // the next call is on its way
    this.forget((board, each) => chosen.get(board) !== each.service);
    for (const [board, name] of chosen) if (!this.followed.has(board)) this.begin(board, name);
  }

  begin(board, service) {
    const each = { service, text: "" };
    each.end = bus.subscribe({ subscribe: `${board}/${service}`, max_hz: kHz }, async (message) => {
      if (message.event !== "value" || message.value === null || typeof message.value !== "object") return;
      const [[name, value] = []] = Object.entries(message.value);
      const model = await model_of(service);
      const event = Object.values(model?.events ?? {}).find((one) => one.name === name);
      const [number] = numbers_of(name, value, event, model?.element);
      const text = number ? with_unit(number.value, number.unit) : "";
      if (text === each.text) return;
      each.text = text;
      this.changed();
    });
    this.followed.set(board, each);
  }

  forget(which) {
    for (const [board, each] of this.followed) {
      if (!which(board, each)) continue;
      each.end();
      this.followed.delete(board);
    }
  }

  end() {
    clearTimeout(this.timer);
    this.wanted = undefined;
    this.forget(() => true);
  }
}
