// SPDX-License-Identifier: Apache-2.0
// How properties were in hours, days and weeks, as a registry kept them.
import { csv_cell, time_of } from "./text.js";

export const kMonthMs = 31 * 86_400_000;
const kUnwrittenMs = 10_000; // a registry writes so often

/// What to ask for so that [from, to] can be shown, and moved a little; undefined where `have`, {from, to}, is enough.
export function wanted(have, from, to, now) {
  const span = to - from;
  const fresh = Math.min(to, now - Math.max(kUnwrittenMs, span / 200));
  if (have && have.from <= from && have.to >= fresh && have.to - have.from <= 4 * span) return undefined;
  return { from: from - span / 2, to: Math.min(now, to + span / 2) };
}

/// The points of an answer: {time, value, low, high}, each of which holds until the next. A gap begins with one without a number.
export function points_of(answer) {
  return (answer.items ?? []).map(([at, value, low = value, high = value]) => ({ time: time_of(at), value: value ?? NaN, low: low ?? NaN, high: high ?? NaN }));
}

/// Those that stand in [from, to].
export const points_within = (points, from, to) => points.filter(({ time }, i) => time <= to && (points[i + 1]?.time ?? Infinity) > from);

/// The columns of `asipctl values -o csv`, behind the name where there are several lines.
export function kept_csv(lines) {
  const several = lines.length > 1;
  const rows = lines.flatMap(({ name, points }) => points.map(({ time, ...numbers }) => (
    [...(several ? [csv_cell(name)] : []), new Date(time).toISOString(), ...["value", "low", "high"].map((each) => (Number.isNaN(numbers[each]) ? "" : numbers[each]))].join(","))));
  return [`${several ? "name," : ""}at,mean,min,max`, ...rows].join("\r\n") + "\r\n";
}
