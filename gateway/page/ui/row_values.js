// SPDX-License-Identifier: Apache-2.0
// A value of each board that is seen in the table. Only of the rows on the screen: each of them is asked of its board.
import { value_service } from "../core/catalogue.js";
import { floats, value_text } from "../core/properties.js";
import { bus, properties_of } from "../net/bus.js";

const kHz = 2;
const kMaxRows = 80;
const kSettleMs = 250; // rows that pass while the user scrolls are not asked

/// The first property of a board that it measures by itself; of this service, where one is named.
async function first_sensor(board, service) {
  const properties = await properties_of(board).catch(() => []);
  return properties.find((each) => (service ? each.service === service && each.kind !== "button" && !floats(each) : each.access === "read" && !each.advanced));
}

export class RowValues {
  /// `changed` is called when a text is another one.
  constructor(changed) {
    this.changed = changed;
    this.followed = new Map(); // board -> {service, text, end}
  }

  text(board) { return this.followed.get(board)?.text ?? ""; }

  /// The rows that are drawn, and of which service a value is wanted: "" the first sensor, "-" none. `passing`: the user scrolls.
  want(rows, service, passing) {
    this.wanted = { rows: rows.slice(0, kMaxRows), service };
    if (this.timer !== undefined && !passing) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.timer = undefined;
      this.follow();
    }, kSettleMs);
  }

  follow() {
    const { rows, service } = this.wanted ?? {};
    if (!rows || document.hidden) return this.forget(() => true);
    const chosen = new Map(rows.map((row) => [row.name, value_service(row, service)]));
    this.forget((board, each) => chosen.get(board) !== each.service);
    for (const [board, name] of chosen) if (name !== undefined && !this.followed.has(board)) this.begin(board, name);
  }

  async begin(board, service) {
    const each = { service, text: "", end: () => {} };
    this.followed.set(board, each);
    const property = await first_sensor(board, service);
    if (!property || this.followed.get(board) !== each) return;
    each.end = bus.subscribe({ subscribe: `${board}/$values`, ids: [property.id], max_hz: kHz }, (message) => {
      if (message.event === "properties") {
        each.end();
        return void this.begin(board, service);
      }
      const text = message.values ? value_text(property, message.values[property.id]?.value) : each.text;
      if (text === each.text) return;
      each.text = text;
      this.changed();
    });
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
