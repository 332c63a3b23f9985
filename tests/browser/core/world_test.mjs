// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { grade_of, kGrades, sensors_of, Trail, World } from "../../../gateway/page/core/world.js";

const measures = { width: 19, off: 40, radius: 90, ahead: 60 };
const square = [[0, 0], [1000, 0], [1000, 800], [0, 800]].map(([x, y]) => ({ x, y }));
const pose = (x, y, more = {}) => ({ x, y, heading: 0, offset: 0, laps: 0, ...more });

function square_world() {
  const world = new World();
  world.floor_said({ floor: measures });
  world.floor_said({ line: square });
  return world;
}

test("the grade grows with the distance from the line, on both sides, and ends at half of what is off", () => {
  assert.equal(grade_of(0, 40), 0);
  assert.equal(grade_of(4.9, 40), 0);
  assert.equal(grade_of(-5, 40), 1);
  assert.equal(grade_of(12, 40), 2);
  assert.equal(grade_of(20, 40), kGrades - 1);
  assert.equal(grade_of(-900, 40), kGrades - 1);
});

test("the sensors are ahead of the axle, where the rover looks", () => {
  const at = sensors_of({ x: 100, y: 50, heading: 90 }, 60);
  assert.ok(Math.abs(at.x - 100) < 1e-9);
  assert.equal(at.y, 110);
});

test("a way is in runs of one grade that hang together", () => {
  const trail = new Trail();
  for (const [x, grade] of [[0, 0], [10, 0], [20, 1], [30, 1]]) trail.add({ x, y: 0 }, grade);
  assert.deepEqual(trail.runs.map((run) => [run.grade, run.points.map((point) => point.x)]), [[0, [0, 10]], [1, [10, 20, 30]]]);
});

test("a rover that stands adds nothing, and one that was put elsewhere leaves no line behind", () => {
  const trail = new Trail();
  for (const x of [0, 1, 2, 3, 0, 500, 510]) trail.add({ x, y: 0 }, 0);
  assert.deepEqual(trail.runs.map((run) => run.points.map((point) => point.x)), [[0], [500, 510]]);
});

test("a way is bounded: the oldest goes first", () => {
  const trail = new Trail();
  for (let i = 0; i < 10_000; ++i) trail.add({ x: i * 10, y: 0 }, 0, 5);
  assert.equal(trail.runs.length, 5);
  assert.ok(trail.runs.every((run) => run.points.length <= 60));
  assert.equal(trail.runs.at(-1).points.at(-1).x, 99_990);
});

test("the picture holds line, obstacles and rovers, and does not tremble while one moves", () => {
  const world = square_world();
  assert.deepEqual(world.bounds(), { x: -100, y: 900, width: 1200, height: 1000 });
  world.floor_said({ obstacles: [{ x: 1500, y: 400, r: 60 }] });
  assert.equal(world.bounds().width, 1700);
  const before = world.bounds();
  for (let x = 0; x < 1000; x += 7) {
    world.moved("mirto", pose(x, 0));
    assert.deepEqual(world.bounds(), before);
  }
  world.moved("mirto", pose(0, -2000));
  assert.equal(world.bounds().height, 3000);
});

test("nothing is known before anything was said", () => {
  assert.equal(new World().bounds(), undefined);
  assert.equal(new World().text(), "Floor with a line");
});

test("poses that come before the floor are not lost, and are bounded", () => {
  const world = new World();
  for (let i = 0; i < 5000; ++i) world.moved("mirto", pose(i * 10, 0));
  assert.equal(world.rovers.size, 0);
  assert.equal(world.early.length, 2000);
  world.floor_said({ floor: measures });
  assert.equal(world.early.length, 0);
  assert.equal(world.rovers.get("mirto").trail.runs[0].points[0].x, 30_060, "the newest ones");
  world.early.push(["gone", pose(0, 0)]);
  world.keep(["mirto"]);
  assert.deepEqual(world.early, []);
});

test("the ways of many rovers that jump are bounded together", () => {
  const world = square_world();
  for (let i = 0; i < 500; ++i) for (let rover = 0; rover < 63; ++rover) world.moved(`rover${rover}`, pose(i % 2 * 1000, rover));
  const runs = [...world.rovers.values()].reduce((sum, rover) => sum + rover.trail.runs.length, 0);
  assert.ok(runs <= 1700 && runs >= 1500, `${runs}`);
});

test("what cannot be drawn is said, until it can be", () => {
  const world = new World();
  assert.equal(world.problem(), "Its floor has said nothing yet.");
  world.floor_said("hello");
  assert.match(world.problem(), /^Not drawn: floor says no measures\.$/);
  world.floor_said({ floor: { ...measures, off: 0 } });
  assert.match(world.problem(), /floor has measures that cannot be drawn/);
  world.floor_said({ line: [{ x: 1, y: 1e308 }] });
  world.floor_said({ obstacles: "many" });
  world.moved("mirto", { x: "1" });
  assert.match(world.problem(), /line has points that cannot be drawn.* …$/);
  world.floor_said({ floor: measures });
  world.floor_said({ line: square });
  world.floor_said({ obstacles: [] });
  assert.equal(world.problem(), "Not drawn: mirto says a pose that cannot be drawn.");
  world.keep([]);
  assert.equal(world.problem(), "");
});

test("laps that are no number are no text", () => {
  const world = square_world();
  for (const laps of [{ toString: 7, valueOf: 7 }, "5", [3], 1e308, 1.5, -1, null]) {
    world.moved("mirto", pose(0, 0, { laps, lap: { toString: 7 } }));
    assert.match(world.text(), /heading 0°$/);
  }
});

test("what others publish in their place does no harm", () => {
  const world = square_world();
  for (const value of [null, undefined, 7, "line", { line: 7 }, { obstacles: { x: 1 } }, { floor: null }, { floor: { ...measures, off: 0 } }, { floor: { width: "19" } }]) world.floor_said(value);
  assert.deepEqual(world.floor, measures);
  world.floor_said({ line: [{ x: 1, y: 2 }, { x: "1", y: 2 }, null, { x: Infinity, y: 0 }, { x: 1e9, y: 0 }] });
  assert.deepEqual(world.line, [{ x: 1, y: 2 }]);
  world.floor_said({ obstacles: [{ x: 0, y: 0, r: -5 }, { x: 0, y: 0, r: 5 }] });
  assert.equal(world.obstacles.length, 1);
  for (const value of [undefined, null, {}, pose("1", 2), pose(1, NaN), pose(1e308, 2), pose(1, 2, { heading: null })]) world.moved("mirto", value);
  assert.equal(world.rovers.size, 0);
  world.floor_said({ floor: { ...measures, off: 1e-320 } });
  assert.deepEqual(world.floor, measures, "where nothing is off the track there are no grades");
  world.floor_said({ line: Array.from({ length: 9000 }, (_, x) => ({ x, y: 0 })) });
  assert.equal(world.line.length, 2000);
});

test("the text says where each rover is", () => {
  const world = square_world();
  world.floor_said({ obstacles: [{ x: 0, y: 0, r: 5 }] });
  world.moved("mirto", pose(120.4, -30, { heading: 90.2, offset: -1.83, laps: 2, lap: 15.776 }));
  world.moved("other", pose(0, 0));
  assert.equal(world.text(), "Floor with a line, 1 obstacle. mirto: 1.8 mm right of the line, at 120, -30 mm, heading 90°; 2 laps, the last in 15.776 s."
    + " other: on the line, at 0, 0 mm, heading 0°");
});

test("ways are cleared, and rovers that went are forgotten", () => {
  const world = square_world();
  world.moved("mirto", pose(0, 0));
  world.moved("other", pose(0, 0));
  world.clear_ways();
  assert.equal(world.rovers.get("mirto").trail.runs.length, 0);
  world.keep(["other"]);
  assert.deepEqual([...world.rovers.keys()], ["other"]);
});
