// SPDX-License-Identifier: Apache-2.0
// Values over time, for plots: bounded, oldest first.
import { csv_cell, time_of } from "./text.js";

/// More values of one event are neither shown nor kept: no user could read them.
export const kMaxNumbers = 256;

/// The single numbers in what one event of a service says that has no properties: [{key, name, value}], the first kMaxNumbers.
export function numbers_of(name, value) {
  if (typeof value === "number" || typeof value === "boolean") return [{ key: name, name, value: Number(value) }];
  return members(value).flatMap(([key, item]) => {
    const label = !Array.isArray(value) ? key : value.length === 1 ? "" : `${name} ${key}`;
    if (typeof item === "number") return [{ key, name: label || name, value: item }];
    return members(item).filter(([, number]) => typeof number === "number")
      .map(([part, number]) => ({ key: `${key}.${part}`, name: label ? `${label} ${part}` : part, value: number }));
  }).slice(0, kMaxNumbers);
}

const members = (value) => (value === null || typeof value !== "object" ? [] : Object.entries(Array.isArray(value) ? value.slice(0, kMaxNumbers) : value).slice(0, kMaxNumbers));

/// Room for one more key in a map that holds kMaxNumbers: the first that is not in `present` goes, and is returned.
export function make_room(map, present) {
  if (map.size < kMaxNumbers) return undefined;
  for (const [key, value] of map) {
    if (present.has(key)) continue;
    map.delete(key);
    return value;
  }
}

/// The points of several lines, at most kMaxNumbers: times and one array of values a line (NaN: none at that time).
export class Series {
  constructor(max_points = 12_000, max_age_ms = 10 * 60 * 1000) {
    this.max_points = max_points;
    this.max_age_ms = max_age_ms;
    this.times = [];
    this.lines = new Map(); // key -> {name, unit, values}
    this.left_out = 0;
  }

  /// Points that are not newer than the last one are skipped: a repeated one changes nothing.
  add(time, numbers) {
    if (this.times.length > 0 && time <= this.times.at(-1)) return false;
    this.times.push(time);
    const by_key = new Map(numbers.map((number) => [number.key, number.value]));
    for (const { key, name, unit } of numbers) {
      if (!this.lines.has(key)) {
        make_room(this.lines, by_key);
        this.lines.set(key, { key, name, unit, values: new Array(this.times.length - 1).fill(NaN) });
      }
    }
    for (const line of this.lines.values()) line.values.push(by_key.get(line.key) ?? NaN);
    this.trim(time);
    return true;
  }

  trim(now) {
    let gone = Math.max(0, this.times.length - this.max_points);
    while (gone < this.times.length && this.times[gone] < now - this.max_age_ms) ++gone;
    // Many at once: moving the rest for each single point would cost more than drawing it.
    if (gone < this.times.length && gone < this.max_points / 8 && this.times.length < this.max_points * 1.25) return;
    this.times.splice(0, gone);
    for (const line of this.lines.values()) line.values.splice(0, gone);
  }

  /// The first index whose time is at least `time`.
  index_at(time) {
    let low = 0;
    let high = this.times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /// A copy that does not change any more.
  frozen() {
    const copy = new Series(this.max_points, this.max_age_ms);
    copy.times = this.times.slice();
    for (const line of this.lines.values()) copy.lines.set(line.key, { ...line, values: line.values.slice() });
    return copy;
  }

  csv(from = -Infinity, to = Infinity) {
    const lines = [...this.lines.values()];
    const rows = [["time", ...lines.map((line) => csv_cell(line.unit ? `${line.name} (${line.unit})` : line.name))].join(",")];
    for (let i = this.index_at(from); i < this.times.length && this.times[i] <= to; ++i) {
      const values = lines.map((line) => (Number.isNaN(line.values[i]) ? "" : line.values[i]));
      rows.push([new Date(this.times[i]).toISOString(), ...values].join(","));
    }
    return rows.join("\r\n") + "\r\n";
  }
}

/// What to draw of one line in [from, to] on `width` columns: for each column with points its first, lowest, highest and
/// last value, so that no peak is lost: [{time, value}].
export function thinned(series, values, from, to, width) {
  const first = Math.max(0, series.index_at(from) - 1);
  const end = Math.min(series.times.length, series.index_at(to) + 1);
  const points = [];
  if (end - first <= width * 2) {
    for (let i = first; i < end; ++i) if (!Number.isNaN(values[i])) points.push({ time: series.times[i], value: values[i] });
    return points;
  }
  const per_ms = width / (to - from);
  let column = NaN;
  let group;
  const flush = () => {
    if (group) for (const i of [...new Set([group.first, group.low, group.high, group.last].sort((a, b) => a - b))]) points.push({ time: series.times[i], value: values[i] });
  };
  for (let i = first; i < end; ++i) {
    if (Number.isNaN(values[i])) continue;
    const at = Math.floor((series.times[i] - from) * per_ms);
    if (at !== column) {
      flush();
      column = at;
      group = { first: i, low: i, high: i, last: i };
    } else {
      if (values[i] < values[group.low]) group.low = i;
      if (values[i] > values[group.high]) group.high = i;
      group.last = i;
    }
  }
  flush();
  return points;
}

const kDayMs = 86_400_000;
const time_steps = [100, 200, 500, ...[1, 2, 5, 10, 15, 30].flatMap((each) => [each * 1000, each * 60_000]), ...[1, 2, 3, 6, 12, 24, 48, 168].map((each) => each * 3_600_000)].sort((a, b) => a - b);

/// Round times where the reader is, about `count` of them within [from, to]; days begin at midnight, weeks on Mondays.
export function time_ticks(from, to, count) {
  const step = time_steps.find((each) => each >= (to - from) / count) ?? time_steps.at(-1);
  const at = new Date(from);
  at.setHours(0, 0, 0, 0);
  const result = [];
  if (step < kDayMs) {
    for (let tick = at.getTime() + Math.ceil((from - at.getTime()) / step) * step; tick <= to; tick += step) result.push(tick);
    return result;
  }
  const days = step / kDayMs;
  const day = (date) => Date.UTC(date.getFullYear(), date.getMonth(), date.getDate()) / kDayMs + 3;
  at.setDate(at.getDate() - (day(at) % days));
  for (; at.getTime() <= to; at.setDate(at.getDate() + days)) if (at.getTime() >= from) result.push(at.getTime());
  return result;
}

/// Round numbers for an axis: at most `count` + 1 of them within [low, high].
export function ticks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((each) => each >= rough) ?? power * 10;
  const result = [];
  const first = Math.ceil(low / step);
  for (let i = 0; i <= count + 1; ++i) { // never more: beside huge numbers a step may change nothing
    const tick = (first + i) * step;
    if (!(tick <= high + step * 1e-9)) break;
    result.push(Number(tick.toPrecision(12)));
  }
  return result;
}

/// The plot of properties with the same unit, from what the gateway keeps: id -> [[time, number]], the newest first.
export function past_series(numbers, past) {
  const at_times = new Map();
  for (const number of numbers) for (const [time, value] of past[number.key] ?? []) {
    const at = time_of(time);
    if (!at_times.has(at)) at_times.set(at, []);
    at_times.get(at).push({ ...number, value });
  }
  const series = new Series();
  for (const [at, points] of [...at_times].sort((a, b) => a[0] - b[0])) series.add(at, points);
  return series;
}
