// SPDX-License-Identifier: Apache-2.0
// The floor of a simulated world, live: the line, the obstacles, the rovers and their ways.
import { t } from "../core/language.js";
import { number_text } from "../core/text.js";
import { kGrades, World } from "../core/world.js";
import { bus } from "../net/bus.js";
import { before_picture, h, Part, set_text, svg as s } from "./dom.js";

export const is_floor = (service) => service.model?.name === "floor" && Boolean(service.model.events);
export const is_pose = (service) => service.model?.name === "pose" && Boolean(service.model.events);

function set(element, name, value) {
  if (element.getAttribute(name) !== String(value)) element.setAttribute(name, value);
}

const points_of = (points) => points.map(({ x, y }) => `${x.toFixed(1)},${(-y).toFixed(1)}`).join(" ");

class WorldPicture extends Part {
  /// Call before it is put into the page. `service` is the name of the floor's.
  begin(board, service) {
    Object.assign(this, { board, service, world: new World() });
    return this;
  }

  shown() {
    this.track = s("polygon", { class: "track" });
    this.obstacles = s("g", { class: "obstacles" });
    this.ways = s("g");
    this.rovers = s("g");
    this.drawn = new Map(); // run -> its polyline
    this.arrows = new Map(); // name of a rover -> {group, name}
    this.svg = s("svg", { role: "img", "aria-label": t("floor-nothing-yet") }, this.track, this.obstacles, this.ways, this.rovers);
    this.problem = h("p", { class: "muted", role: "status", hidden: true });
    this.texts = h("ul", { class: "rovers" });
    this.signs = h("p", { class: "way-signs muted" });
    this.append(this.svg, this.problem, this.texts, this.signs, h("button", { onclick: () => { this.world.clear_ways(); this.refresh(); } }, t("clear-ways")));
    this.refresh = before_picture(() => this.draw());
    this.while_shown(bus.subscribe({ subscribe: `${this.board}/${this.service}` }, (message) => {
      if (message.event !== "value") return;
      this.world.floor_said(message.value);
      this.refresh();
    }));
    this.every(1000, () => this.describe());
  }

  moved(name, value) {
    if (value?.pose === undefined) return; // it says something else
    this.world.moved(name, value.pose);
    this.refresh?.();
  }

  keep(names) {
    this.world.keep(names);
    this.refresh?.();
  }

  draw() {
    const { floor } = this.world;
    const bounds = this.world.bounds();
    if (!floor || !bounds) return;
    set(this.svg, "viewBox", `${bounds.x} ${-bounds.y} ${bounds.width} ${bounds.height}`);
    set(this.track, "points", points_of(this.world.line));
    set(this.track, "stroke-width", floor.width);
    this.draw_obstacles();
    this.draw_ways();
    this.draw_rovers(floor.radius);
    if (this.texts.children.length !== this.world.rovers.size || this.signs.children.length === 0) this.describe();
  }

  draw_obstacles() {
    const key = JSON.stringify(this.world.obstacles);
    if (key === this.obstacles_key) return;
    this.obstacles_key = key;
    this.obstacles.replaceChildren(...this.world.obstacles.map(({ x, y, r }) => s("circle", { cx: x, cy: -y, r })));
  }

  draw_ways() {
    const runs = new Set([...this.world.rovers.values()].flatMap((rover) => rover.trail.runs));
    for (const [run, line] of this.drawn) {
      if (runs.has(run)) continue;
      line.remove();
      this.drawn.delete(run);
    }
    for (const run of runs) {
      const line = this.drawn.get(run) ?? s("polyline", { class: `way grade${run.grade}` });
      if (!this.drawn.has(run)) this.ways.append(line);
      this.drawn.set(run, line);
      if (line.shown_points === run.points.length) continue;
      line.shown_points = run.points.length;
      set(line, "points", points_of(run.points));
    }
  }

  draw_rovers(radius) {
    const { rovers } = this.world;
    for (const [name, arrow] of this.arrows) {
      if (rovers.has(name)) continue;
      arrow.remove();
      this.arrows.delete(name);
    }
    for (const [name, { pose }] of rovers) {
      let arrow = this.arrows.get(name);
      if (!arrow) {
        arrow = s("g", { class: "rover", "data-rover": name }, s("circle"), s("path", { d: "M.8 0L-.5 .5L-.2 0L-.5-.5Z" }), s("text", { "text-anchor": "middle", y: -1.2 }));
        this.arrows.set(name, arrow);
        this.rovers.append(arrow);
      }
      const [body, head, label] = arrow.children;
      set(arrow, "transform", `translate(${pose.x} ${-pose.y}) scale(${radius})`);
      set(body, "r", 1);
      set(head, "transform", `rotate(${-pose.heading})`);
      set_text(label, rovers.size > 1 ? name : "");
    }
  }

  /// Once a second: a text that changes with each pose could not be read.
  describe() {
    const { floor, rovers } = this.world;
    const problem = this.world.problem();
    set_text(this.problem, problem);
    this.problem.hidden = problem === "";
    if (!floor) return;
    set(this.svg, "aria-label", this.world.text());
    const texts = this.world.rover_texts();
    while (this.texts.children.length > texts.length) this.texts.lastChild.remove();
    texts.forEach((text, i) => set_text(this.texts.children[i] ?? this.texts.appendChild(h("li", {})), text));
    const edge = (grade) => Number((floor.off / 2 * grade / kGrades).toFixed(1));
    const signs = Array.from({ length: kGrades }, (_, grade) => (grade === kGrades - 1 ? t("way-mm-more", { way: number_text(edge(grade)) }) : t("under-way-mm", { way: number_text(edge(grade + 1)) })));
    if (this.signs.textContent !== [t("from-the-line"), " ", ...signs].join("")) {
      this.signs.replaceChildren(t("from-the-line"), " ", ...signs.map((text, grade) => h("span", { class: `way-sign grade${grade}` }, text)));
    }
    const scale = this.svg.viewBox.baseVal.width / Math.max(1, this.svg.clientWidth);
    for (const name of rovers.keys()) this.arrows.get(name)?.lastChild.setAttribute("font-size", 14 * scale / floor.radius);
  }
}

customElements.define("asip-world", WorldPicture);
