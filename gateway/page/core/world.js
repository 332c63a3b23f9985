// SPDX-License-Identifier: Apache-2.0
// A floor with a line and the rovers on it, as their services say: millimetres, y upwards, degrees counter-clockwise.
import { number_text, plural } from "./text.js";

export const kGrades = 4;
const kStepMm = 4;
const kJumpMm = 150;     // further in one step: it was put there
const kRunPoints = 60;
const kMaxRuns = 400;
const kMaxItems = 2000;
const kFarMm = 1e6;
const kRoomMm = 100;

const known = (item, names) => names.every((name) => typeof item?.[name] === "number" && Math.abs(item[name]) <= kFarMm);
const list = (items, names) => (Array.isArray(items) ? items.slice(0, kMaxItems).filter((item) => known(item, names)) : []);

/// How far from the line: 0 on it, kGrades - 1 at half of what is off the track and beyond.
export function grade_of(offset, off) { return Math.min(kGrades - 1, Math.floor(Math.abs(offset) / (off / 2) * kGrades)); }

/// Where the middle of its sensors is.
export function sensors_of({ x, y, heading }, ahead) {
  const angle = heading * Math.PI / 180;
  return { x: x + ahead * Math.cos(angle), y: y + ahead * Math.sin(angle) };
}

/// The way of one rover in runs of one grade each: [{grade, points}]. The oldest run goes when there are too many.
export class Trail {
  constructor(max_runs = kMaxRuns) {
    this.max_runs = max_runs;
    this.runs = [];
  }

  add(at, grade) {
    const run = this.runs.at(-1);
    const last = run?.points.at(-1);
    const way = last ? Math.hypot(at.x - last.x, at.y - last.y) : Infinity;
    if (way < kStepMm) return;
    const goes_on = way <= kJumpMm;
    if (goes_on && run.grade === grade && run.points.length < kRunPoints) run.points.push(at);
    else this.runs.push({ grade, points: goes_on ? [last, at] : [at] });
    if (this.runs.length > this.max_runs) this.runs.shift();
  }
}

export class World {
  constructor() {
    this.floor = undefined; // {width, off, radius, ahead}
    this.line = [];
    this.obstacles = [];
    this.rovers = new Map(); // name -> {pose, trail}
    this.early = [];         // poses before the floor was known
  }

  /// A value of the floor's service. Whatever is not as it should be is left out.
  floor_said(value) {
    if (value?.line) this.line = list(value.line, ["x", "y"]);
    if (value?.obstacles) this.obstacles = list(value.obstacles, ["x", "y", "r"]).filter((each) => each.r > 0);
    if (!known(value?.floor, ["width", "off", "radius", "ahead"]) || !(value.floor.off > 0 && value.floor.radius > 0 && value.floor.width > 0)) return;
    this.floor = value.floor;
    for (const [name, pose] of this.early.splice(0)) this.moved(name, pose);
  }

  moved(name, pose) {
    if (!known(pose, ["x", "y", "heading", "offset"])) return;
    if (!this.floor) return void (this.early.length < kMaxItems && this.early.push([name, pose]));
    const rover = this.rovers.get(name) ?? { trail: new Trail() };
    this.rovers.set(name, rover);
    rover.pose = pose;
    rover.trail.add(sensors_of(pose, this.floor.ahead), grade_of(pose.offset, this.floor.off));
  }

  /// Forgets the rovers that are not named.
  keep(names) { for (const name of [...this.rovers.keys()]) if (!names.includes(name)) this.rovers.delete(name); }

  clear_ways() { for (const rover of this.rovers.values()) rover.trail = new Trail(); }

  /// What a picture has to hold, in steps so that it does not tremble: {x, y, width, height}, y the upper edge.
  bounds() {
    const spots = [...this.line.map((at) => [at, kRoomMm]), ...this.obstacles.map((at) => [at, at.r]), ...[...this.rovers.values()].map(({ pose }) => [pose, kRoomMm])];
    if (spots.length === 0) return undefined;
    const low = (axis) => Math.floor(Math.min(...spots.map(([at, room]) => at[axis] - room)) / kRoomMm) * kRoomMm;
    const high = (axis) => Math.ceil(Math.max(...spots.map(([at, room]) => at[axis] + room)) / kRoomMm) * kRoomMm;
    return { x: low("x"), y: high("y"), width: high("x") - low("x"), height: high("y") - low("y") };
  }

  /// Lines of text that say what the picture shows, one for each rover.
  rover_texts() { return [...this.rovers].map(([name, { pose }]) => `${name}: ${pose_text(pose)}`); }

  text() {
    const things = this.obstacles.length > 0 ? `, ${plural(this.obstacles.length, "obstacle")}` : "";
    return [`Floor with a line${things}`, ...this.rover_texts()].join(". ");
  }
}

function pose_text({ x, y, heading, offset, laps, lap }) {
  const side = Math.abs(offset) < 0.05 ? "on the line" : `${Number(Math.abs(offset).toFixed(1))} mm ${offset > 0 ? "left" : "right"} of the line`;
  const rounds = laps > 0 ? `; ${plural(laps, "lap")}${typeof lap === "number" ? `, the last in ${number_text(lap)} s` : ""}` : "";
  return `${side}, at ${Math.round(x)}, ${Math.round(y)} mm, heading ${Math.round(heading)}°${rounds}`;
}
