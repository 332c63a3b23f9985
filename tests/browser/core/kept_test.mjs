// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { kept_csv, points_of, points_within, wanted } from "../../../gateway/page/core/kept.js";
import { tick_text } from "../../../gateway/page/core/text.js";
import { time_ticks } from "../../../gateway/page/core/series.js";

const kHour = 3_600_000;
const at = (hour) => `2026-11-26T${String(hour).padStart(2, "0")}:00:00.000Z`;
const ms = (hour) => Date.parse(at(hour));
const answer = { registry: "first", level: "minutes", items: [[at(1), 20.5], [at(2), 21, 20, 23.5], [at(3), null], [at(5), 19]] };

test("an answer is points with a band, and gaps where nothing is known", () => {
  assert.deepEqual(points_of(answer), [{ time: ms(1), value: 20.5, low: 20.5, high: 20.5 }, { time: ms(2), value: 21, low: 20, high: 23.5 },
    { time: ms(3), value: NaN, low: NaN, high: NaN }, { time: ms(5), value: 19, low: 19, high: 19 }]);
  assert.deepEqual(points_of({ find: "values" }), [], "nothing is kept");
});

test("a point stands until the next one, so the last before a time is in it", () => {
  assert.deepEqual(points_within(points_of(answer), ms(1) + 1, ms(2) - 1).map((each) => each.value), [20.5]);
  assert.deepEqual(points_within(points_of(answer), ms(6), ms(7)).map((each) => each.value), [19]);
  assert.deepEqual(points_within(points_of(answer), ms(4), ms(6)).map((each) => each.value), [NaN, 19]);
});

test("a time is asked for with half of it on both sides, and never of the future", () => {
  const now = ms(12);
  assert.deepEqual(wanted(undefined, ms(4), ms(6), now), { from: ms(3), to: ms(7) });
  assert.deepEqual(wanted(undefined, ms(11), ms(12), now), { from: ms(11) - kHour / 2, to: now });
});

test("what is there is not asked for again: not while it is moved a little, nor zoomed in a little", () => {
  const have = { from: ms(3), to: ms(7) };
  assert.equal(wanted(have, ms(4), ms(6), ms(12)), undefined);
  assert.equal(wanted(have, ms(3), ms(5), ms(12)), undefined);
  assert.equal(wanted(have, ms(4), ms(5), ms(12)), undefined);
  assert.deepEqual(wanted(have, ms(2), ms(4), ms(12)), { from: ms(1), to: ms(5) }, "before it");
  assert.notEqual(wanted(have, ms(4), ms(4) + kHour / 2, ms(12)), undefined, "too coarse");
});

test("a picture that follows the time asks again once that shows: after ten seconds, or a two-hundredth", () => {
  const have = { from: ms(10), to: ms(12) };
  assert.equal(wanted(have, ms(11) + 9000, ms(12) + 9000, ms(12) + 9000), undefined);
  assert.notEqual(wanted(have, ms(11) + 19_000, ms(12) + 19_000, ms(12) + 19_000), undefined);
});

test("the CSV has the columns of asipctl, empty ones in a gap, and the name where there are several", () => {
  const line = { name: "Temperature", points: points_of(answer).slice(1, 3) };
  assert.equal(kept_csv([line]), `at,mean,min,max\r\n${at(2)},21,20,23.5\r\n${at(3)},,,\r\n`);
  assert.match(kept_csv([line, { ...line, name: "=cmd|'x'" }]), /\r\n"'=cmd\|'x'",/);
  assert.match(kept_csv([line, { ...line, name: 'Out "door"' }]), /^name,at,mean,min,max\r\n"Temperature",.*\r\n.*\r\n"Out ""door""",/);
});

test("an axis of hours has hours, one of weeks has days, and midnight says its day", () => {
  const day = new Date(2026, 10, 26).getTime();
  const text = (from, to, count) => time_ticks(from, to, count).map((each) => tick_text(each, true));
  assert.deepEqual(text(day - 5 * kHour, day + 8 * kHour, 5), ["21:00", "26 Nov", "03:00", "06:00"]);
  assert.deepEqual(text(day + kHour, day + 73 * kHour, 4), ["27 Nov", "28 Nov", "29 Nov"]);
  assert.deepEqual(time_ticks(day, day + 31 * 24 * kHour, 6).map((each) => new Date(each).getDay()), [1, 1, 1, 1], "weeks begin on Mondays");
  assert.deepEqual(time_ticks(day + 400, day + 3400, 3).map((each) => each - day), [1000, 2000, 3000]);
  assert.equal(tick_text(day + 1000, false), "00:00:01");
});

test("days that are shorter or longer have their midnights", () => {
  for (const month of [2, 9]) for (const tick of time_ticks(new Date(2026, month, 20).getTime(), new Date(2026, month, 34).getTime(), 14)) assert.equal(new Date(tick).getHours(), 0);
});
