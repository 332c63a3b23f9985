// SPDX-License-Identifier: Apache-2.0
// What a plot shows beyond the last minutes: asked of a registry by the gateway.
import { kMonthMs, points_of, points_within, wanted } from "../core/kept.js";
import { t } from "../core/language.js";
import { day_text, time_of } from "../core/text.js";
import { request } from "../net/bus.js";

const kPoints = 1000;
const kAgainMs = 10_000;
const kMinuteMs = 60_000;

export class Kept {
  /// `path` of a property and of what is asked of it. `lines`: a function that gives [{key, name, unit}] of the properties, now. `reach`: how far back it may.
  constructor(path, lines, reach = kMonthMs) {
    Object.assign(this, { path, lines, reach, version: 0, again_at: 0 });
  }

  ask(property, { from, to }) {
    const asked = { from: new Date(from).toISOString(), to: new Date(to).toISOString(), points: kPoints };
    return request(this.path(property, asked));
  }

  /// Asks for what a picture of this time needs; one thing at a time, and not again at once where that failed.
  async want(from, to) {
    const now = Date.now();
    const next = this.asking || now < this.again_at ? undefined : wanted(this.have, from, to, now);
    if (!next) return;
    this.asking = true;
    try {
      const lines = [];
      for (const line of this.lines()) {
        const answer = await this.ask(line.key, next);
        lines.push({ key: line.key, name: line.name, unit: line.unit, end: next.to, points: points_of(answer) });
        if (answer.level) this.said ??= await this.begin_of(line.key, now);
      }
      this.have = { ...next, lines };
      this.problem = undefined;
    } catch (problem) {
      this.problem = problem.message;
      this.again_at = Date.now() + kAgainMs;
    }
    this.asking = false;
    ++this.version;
  }

  /// Who keeps it, and since when, in words.
  async begin_of(property, now) {
    const { registry, items } = await this.ask(property, { from: now - this.reach, to: now });
    const since = time_of(items?.[0]?.[0]) ?? now;
    return since > now - this.reach + kMinuteMs ? t("kept-since", { registry, since: day_text(since) }) : this.reach === kMonthMs ? t("kept-longer", { registry }) : "";
  }

  shown(from, to) {
    return (this.have?.lines ?? []).map((line) => ({ ...line, points: points_within(line.points, from, to) }));
  }

  get note() { return this.problem ?? (this.have ? this.said ?? t("kept-none") : "…"); }
}

/// Each point holds until the next; how far the values around a mean went is a band.
export function draw_steps(context, { color, points, end }, x_of, y_of) {
  const pieces = points.map((point, i) => ({ ...point, from: x_of(point.time), to: x_of(points[i + 1]?.time ?? end) }));
  context.strokeStyle = context.fillStyle = color;
  context.lineWidth = 1.5;
  context.globalAlpha = 0.25;
  for (const { from, to, low, high } of pieces) if (high > low) context.fillRect(from, y_of(high), Math.max(1, to - from), y_of(low) - y_of(high));
  context.globalAlpha = 1;
  context.beginPath();
  let known = false;
  for (const { value, from, to } of pieces) {
    const y = y_of(value);
    if (!Number.isNaN(value)) {
      if (known) context.lineTo(from, y);
      else context.moveTo(from, y);
      context.lineTo(Math.max(to, from + 1), y);
    }
    known = !Number.isNaN(value);
  }
  context.stroke();
}
