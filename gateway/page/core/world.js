// SPDX-License-Identifier: Apache-2.0
// A floor with a line and the rovers on it, as their services say: millimetres, y upwards, degrees counter-clockwise.
import { t } from "./language.js";
import { number_text } from "./text.js";

export const kGrades = 4;
const kStepMm = 4;
const kJumpMm = 150;     // further in one step: it was put there
const kRunPoints = 60;
const kMaxRuns = 400;    // of one rover
const kMaxAllRuns = 1600;
const kMaxItems = 2000;
const kFarMm = 1e6;
const kRoomMm = 100;
const kMeasures = ["width", "off", "radius"];
const kOfFloor = ["floor", "line", "obstacles"];
const kLeastMm = 0.01;   // of a measure

const known = (item, names) => names.every((name) => typeof item?.[name] === "number" && Math.abs(item[name]) <= kFarMm);
const list = (items, names) => (Array.isArray(items) ? items.slice(0, kMaxItems).filter((item) => known(item, names)) : []);

/// How far from the line: 0 on it, kGrades - 1 at half of what is off the track and beyond.
export function grade_of(offset, off) { return Math.min(kGrades - 1, Math.floor(Math.abs(offset) / (off / 2) * kGrades)); }

/// Where the middle of its sensors is.
export function sensors_of({ x, y, heading }, ahead) {
  const angle = heading * Math.PI / 180;
  return { x: x + ahead * Math.cos(angle), y: y + ahead * Math.sin(angle) };
}

/// The way of one rover in runs of one grade each: [{grade, points}]. The oldest runs go when there are too many.
export class Trail {
  constructor() { this.runs = []; }

  add(at, grade, max_runs = kMaxRuns) {
    const run = this.runs.at(-1);
    const last = run?.points.at(-1);
    const way = last ? Math.hypot(at.x - last.x, at.y - last.y) : Infinity;
    if (way < kStepMm) return;
    const goes_on = way <= kJumpMm;
    if (goes_on && run.grade === grade && run.points.length < kRunPoints) run.points.push(at);
    else this.runs.push({ grade, points: goes_on ? [last, at] : [at] });
    if (this.runs.length > max_runs) this.runs.splice(0, this.runs.length - max_runs);
  }
}

export class World {
  constructor() {
    this.floor = undefined; // {width, off, radius, ahead}
    this.line = [];
    this.obstacles = [];
    this.rovers = new Map(); // name -> {pose, trail}
    this.early = [];         // poses before the floor was known, the newest
    this.faults = new Map(); // what was said last and cannot be drawn: "floor", "line", "obstacles" or a rover's name -> why
  }

  /// A value of the floor's service. Whatever is not as it should be is left out, and is a fault.
  floor_said(value) {
    if (value === null || typeof value !== "object") return void this.check("floor", false, t("says-no-measures"));
    if ("line" in value) this.line = this.checked_list("line", value.line, ["x", "y"]);
    if ("obstacles" in value) this.obstacles = this.checked_list("obstacles", value.obstacles, ["x", "y", "r"]).filter((each) => each.r > 0);
    if (!("floor" in value)) return;
    const { floor } = value;
    const good = known(floor, [...kMeasures, "ahead"]) && kMeasures.every((name) => floor[name] >= kLeastMm);
    if (!this.check("floor", good, t("measures-cannot"))) return;
    this.floor = floor;
    for (const [name, pose] of this.early.splice(0)) this.moved(name, pose);
  }

  checked_list(name, items, members) {
    const good = list(items, members);
    this.check(name, Array.isArray(items) && good.length === items.length, t("points-cannot", { most: kMaxItems }));
    return good;
  }

  check(name, good, fault) {
    if (good) this.faults.delete(name);
    else this.faults.set(name, fault);
    return good;
  }

  moved(name, pose) {
    if (!this.check(name, known(pose, ["x", "y", "heading", "offset"]), t("says-pose"))) return;
    if (!this.floor) {
      if (this.early.push([name, pose]) > kMaxItems) this.early.shift();
      return;
    }
    const rover = this.rovers.get(name) ?? { trail: new Trail() };
    this.rovers.set(name, rover);
    rover.pose = pose;
    const max_runs = Math.min(kMaxRuns, Math.ceil(kMaxAllRuns / this.rovers.size));
    rover.trail.add(sensors_of(pose, this.floor.ahead), grade_of(pose.offset, this.floor.off), max_runs);
  }

  /// Forgets the rovers that are not named.
  keep(names) {
    for (const name of [...this.rovers.keys()]) if (!names.includes(name)) this.rovers.delete(name);
    for (const name of [...this.faults.keys()]) if (!names.includes(name) && !kOfFloor.includes(name)) this.faults.delete(name);
    this.early = this.early.filter(([name]) => names.includes(name));
  }

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

  /// Why something is not drawn; "" while all is.
  problem() {
    const faults = [...this.faults].map(([name, why]) => `${name} ${why}`);
    if (!this.floor && faults.length === 0) return t("floor-said");
    return faults.length === 0 ? "" : t("not-drawn-faults", { faults: faults.slice(0, 3).join("; ") }) + (faults.length > 3 ? " …" : ".");
  }

  text() {
    const things = this.obstacles.length > 0 ? `, ${t("n-obstacles", { n: this.obstacles.length })}` : "";
    return [t("floor-line") + things, ...this.rover_texts()].join(". ");
  }
}

const way_text = (offset) => number_text(Math.round(Math.abs(offset) * 10) / 10);

function pose_text({ x, y, heading, offset, laps, lap }) {
  const side = Math.abs(offset) < 0.05 ? t("on-the-line") : (offset > 0 ? t("way-mm", { way: way_text(offset) }) : t("way-mm-right", { way: way_text(offset) }));
  const rounds = Number.isSafeInteger(laps) && laps > 0 ? `; ${t("n-laps", { n: laps })}${typeof lap === "number" ? `, ${t("last-lap", { lap: number_text(lap) })}` : ""}` : "";
  return t("side-x", { side, x: Math.round(x), y: Math.round(y), heading: Math.round(heading) }) + rounds;
}
