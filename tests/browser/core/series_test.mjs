// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { kMaxNumbers, numbers_of, Series, thinned, ticks } from "../../../gateway/page/core/series.js";

const one = (value) => [{ key: "a", name: "a", value }];

test("Numbers_AreFoundInEveryShapeOfAReport", () => {
  const found = (name, value) => numbers_of(name, value).map((each) => [each.key, each.name, each.value]);
  assert.deepEqual(found("distance", [42, 118]), [["0", "distance 0", 42], ["1", "distance 1", 118]]);
  assert.deepEqual(found("distance", [42]), [["0", "distance", 42]]);
  assert.deepEqual(found("wheel", [{ pulse: 3000, count: 11 }, { count: 2 }]), [["0.pulse", "wheel 0 pulse", 3000], ["0.count", "wheel 0 count", 11], ["1.count", "wheel 1 count", 2]]);
  assert.deepEqual(found("acceleration", { x: 1, y: -2 }), [["x", "x", 1], ["y", "y", -2]]);
  assert.deepEqual(found("count", 16), [["count", "count", 16]]);
  assert.deepEqual(found("text", "hello"), []);
  assert.deepEqual(found("nothing", null), []);
});

test("MorePointsThanFit_DropsTheOldest", () => {
  const series = new Series(100, 1e9);
  for (let i = 0; i < 1000; ++i) series.add(i, one(i));
  assert.ok(series.times.length <= 125);
  assert.equal(series.times.at(-1), 999);
  assert.equal(series.lines.get("a").values.length, series.times.length);
});

test("PointsOlderThanTheAge_AreDropped", () => {
  const series = new Series(100, 1000);
  for (let i = 0; i < 50; ++i) series.add(i, one(i));
  series.add(5000, one(1));
  assert.deepEqual(series.times, [5000]);
});

test("PointThatIsNotNewer_IsSkipped", () => {
  const series = new Series();
  series.add(10, one(1));
  assert.equal(series.add(10, one(2)), false);
  assert.equal(series.add(9, one(3)), false);
  assert.deepEqual(series.lines.get("a").values, [1]);
});

test("LineThatAppearsLater_HasNothingBefore", () => {
  const series = new Series();
  series.add(1, one(1));
  series.add(2, [{ key: "b", name: "b", value: 5 }]);
  assert.deepEqual(series.lines.get("b").values, [NaN, 5]);
  assert.deepEqual(series.lines.get("a").values, [1, NaN]);
});

test("ManyPoints_ThinnedKeepsEveryPeakAndBothEnds", () => {
  const series = new Series(20_000, 1e9);
  for (let i = 0; i < 10_000; ++i) series.add(i, one(i === 5003 ? 99 : i === 7001 ? -99 : i % 2));
  const points = thinned(series, series.lines.get("a").values, 0, 10_000, 100);
  assert.ok(points.length <= 404, `${points.length}`);
  assert.ok(points.some(({ time, value }) => time === 5003 && value === 99));
  assert.ok(points.some(({ time, value }) => time === 7001 && value === -99));
  assert.equal(points[0].time, 0);
  assert.equal(points.at(-1).time, 9999);
  assert.ok(points.every((point, i) => i === 0 || point.time > points[i - 1].time));
});

test("Window_TakesOnePointBeyondEachEdge", () => {
  const series = new Series();
  for (let i = 0; i < 100; ++i) series.add(i * 10, one(i));
  const points = thinned(series, series.lines.get("a").values, 205, 295, 100);
  assert.equal(points[0].time, 200);
  assert.equal(points.at(-1).time, 300);
});

test("Csv_HasTimeUnitsAndAllPoints", () => {
  const series = new Series();
  series.add(0, [{ key: "0", name: "sensor 0", unit: "cm", value: 42 }]);
  series.add(1000, [{ key: "1", name: "=cmd, \"x\"", value: 7 }]);
  assert.equal(series.csv(), 'time,"sensor 0 (cm)","\'=cmd, ""x"""\r\n1970-01-01T00:00:00.000Z,42,\r\n1970-01-01T00:00:01.000Z,,7\r\n');
  assert.equal(series.csv(500, 2000).split("\r\n").length, 3);
});

test("FrozenSeries_DoesNotChange", () => {
  const series = new Series();
  series.add(1, one(1));
  const frozen = series.frozen();
  series.add(2, one(2));
  assert.deepEqual(frozen.times, [1]);
});

test("Ticks_AreRoundAndWithin", () => {
  assert.deepEqual(ticks(0, 100, 5), [0, 20, 40, 60, 80, 100]);
  assert.deepEqual(ticks(-0.3, 0.3, 3), [-0.2, 0, 0.2]);
  assert.deepEqual(ticks(17, 18, 2), [17, 17.5, 18]);
});

test("Axis_OfNumbersThatAStepDoesNotChange_Ends", () => {
  for (const [low, high] of [[1e17, 1e17 + 16], [-1e308, 1e308], [0, 5e-324], [NaN, 1], [1, 1], [Infinity, Infinity]]) {
    assert.ok(ticks(low, high, 5.5).length <= 7, `${low} ${high}`);
  }
});

test("EverNewNames_DoNotGrowWithoutBound", () => {
  const series = new Series();
  for (let i = 0; i < 5000; ++i) series.add(i, [{ key: `k${i}`, name: `k${i}`, value: i }]);
  assert.equal(series.lines.size, kMaxNumbers);
  assert.ok(series.lines.has("k4999"), "the newest");
  assert.equal(numbers_of("many", new Array(100_000).fill(1)).length, kMaxNumbers);
  assert.equal(numbers_of("many", Object.fromEntries(Array.from({ length: 5000 }, (_, i) => [`k${i}`, { a: 1, b: 2 }]))).length, kMaxNumbers);
  assert.equal(numbers_of("deep", [new Array(5000).fill(1)]).length, kMaxNumbers);
});
