// SPDX-License-Identifier: Apache-2.0
// A plot on a canvas: follows, pauses, zooms, and gives its points as CSV. The last minutes are those that this page and its gateway
// have; of hours, days and weeks a registry is asked.
import { kept_csv, kMonthMs } from "../core/kept.js";
import { locale, t } from "../core/language.js";
import { thinned, ticks, time_ticks } from "../core/series.js";
import { moment_text, number_text, tick_text, unit_text, with_unit } from "../core/text.js";
import { h, Part, set_text } from "./dom.js";
import { draw_steps } from "./kept.js";

const spans = [["10 s", 10_000], ["1 min", 60_000], ["10 min", 600_000]];
const one = (unit) => new Intl.NumberFormat(locale, { style: "unit", unit, unitDisplay: "long" }).format(1);
/// What a registry keeps, by the names that a widget has for it.
export const kept_spans = { hour: ["1 h", 3_600_000], day: [one("day"), 86_400_000], week: [one("week"), 604_800_000], month: [one("month"), kMonthMs] };
export const kFirst = spans[1];
const kMinSpanMs = 500;
const kLiveMs = 600_000; // beyond, a registry is asked
const kColors = 6;
const kGapMs = 3000;
const left = 48;
const bottom = 20;

class Plot extends Part {
  /// Call before it is put into the page. `label` is for people who cannot see it, `file` the name of the CSV. `kept`: a Kept, where
  /// a registry may have kept it. `span`: what it shows at first.
  begin(series, label, file, kept, [, span] = kFirst) {
    Object.assign(this, { live: series, series, label, file, kept, span });
    return this;
  }

  /// Other points from now on.
  shows(series) {
    if (this.series === this.live) this.series = series;
    this.live = series;
  }

  shown() {
    this.end = undefined; // paused: where the picture ends; else it follows the time
    this.hidden_lines = new Set();
    this.canvas = h("canvas", { role: "img", tabindex: "0", onwheel: (event) => this.wheel(event), onkeydown: (event) => this.key(event),
      onpointerdown: (event) => this.grab(event), onpointermove: (event) => this.point(event), onpointerleave: (event) => { if (event.pointerType === "mouse") this.cursor = undefined; } });
    this.pause_button = h("button", { onclick: () => this.pause(this.end === undefined) }, t("pause"));
    this.spans = [...spans, ...Object.values(kept_spans).filter(([, ms]) => ms <= this.longest)].map(([text, ms]) => [h("button", { "aria-label": t("show-text", { text }), onclick: () => this.zoom_to(ms) }, text), ms]);
    this.note = h("p", { class: "muted note", role: "status" });
    this.legend = h("div", { class: "legend" });
    this.append(this.canvas, this.legend, this.note, h("div", { class: "plot-tools", role: "group", "aria-label": t("plot-label", { label: this.label }) },
      this.pause_button, h("button", { "aria-label": t("zoom"), onclick: () => this.zoom(0.5) }, "+"),
      h("button", { "aria-label": t("zoom-out"), onclick: () => this.zoom(2) }, "−"), this.spans.map(([button]) => button),
      h("button", { onclick: () => this.save() }, "CSV")));
    const resized = new ResizeObserver(() => this.resize());
    resized.observe(this.canvas);
    this.while_shown(() => resized.disconnect());
    const seen = new IntersectionObserver((changes) => { this.seen = changes.at(-1).isIntersecting; });
    seen.observe(this.canvas);
    this.while_shown(() => seen.disconnect());
    const dark = matchMedia("(prefers-color-scheme: dark)");
    this.listen(dark, "change", () => this.read_colors());
    this.read_colors();
    let frame = 0;
    const draw = () => {
      frame = requestAnimationFrame(draw);
      this.draw();
    };
    draw();
    this.while_shown(() => cancelAnimationFrame(frame));
    this.every(2000, () => this.describe());
    this.zoom_to(this.span);
    this.describe();
  }

  read_colors() {
    const style = getComputedStyle(this);
    this.colors = Array.from({ length: kColors }, (_, i) => style.getPropertyValue(`--line${i}`).trim());
    this.ink = style.getPropertyValue("--muted").trim();
    this.grid = style.getPropertyValue("--line").trim();
    this.font = `12px ${style.fontFamily}`;
    this.drawn = undefined;
  }

  resize() {
    const ratio = devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
    this.drawn = undefined;
  }

  pause(on) {
    this.end = on ? Date.now() : undefined;
    this.series = on ? this.live.frozen() : this.live;
    this.pause_button.textContent = on ? t("follow") : t("pause");
    this.describe();
  }

  zoom_to(ms, at = 1) {
    const span = Math.max(kMinSpanMs, Math.min(this.longest, ms));
    if (this.end !== undefined) this.end -= (this.span - span) * (1 - at);
    this.span = span;
    for (const [button, each] of this.spans) button.setAttribute("aria-pressed", each === span);
  }

  zoom(factor, at = this.end === undefined ? 1 : 0.5) { this.zoom_to(this.span * factor, at); }

  wheel(event) {
    if (!event.ctrlKey && !event.shiftKey && document.activeElement !== this.canvas) return; // the page scrolls
    event.preventDefault();
    this.zoom(event.deltaY > 0 ? 1.25 : 0.8, Math.max(0, (event.offsetX - left) / (this.width - left)));
  }

  key(event) {
    const moves = { ArrowLeft: -0.2, ArrowRight: 0.2 };
    if (event.key in moves) {
      if (this.end === undefined) this.pause(true);
      this.end += this.span * moves[event.key];
    } else if (event.key === "+") this.zoom(0.5);
    else if (event.key === "-") this.zoom(2);
    else if (event.key === " ") this.pause(this.end === undefined);
    else return;
    event.preventDefault();
  }

  grab(event) {
    this.canvas.focus();
    this.cursor = event.offsetX;
    this.canvas.setPointerCapture(event.pointerId);
    this.grabbed = { x: event.clientX };
  }

  point(event) {
    this.cursor = event.offsetX;
    if (!event.buttons || !this.grabbed) return;
    const moved = event.clientX - this.grabbed.x;
    if (this.end === undefined && Math.abs(moved) < 6) return;
    if (this.end === undefined) this.pause(true);
    this.end -= moved * this.span / (this.width - left);
    this.grabbed.x = event.clientX;
  }

  get longest() { return this.kept?.reach ?? kLiveMs; }

  /// Whether the picture is of what was kept.
  get far() { return this.kept !== undefined && this.span > kLiveMs; }

  describe() {
    const to = this.end ?? Date.now();
    const from = to - this.span;
    const lines = this.far ? this.kept.shown(from, to).map((line) => {
      const [low, high] = bounds_of([line]);
      return `${line.name}: ${low > high ? t("nothing-yet-within").toLowerCase() : t("min-max", { min: with_unit(low, line.unit), max: with_unit(high, line.unit) })}`;
    }) : [...this.series.lines.values()].map((line) => {
      const last = line.values.findLast((value) => !Number.isNaN(value));
      return last === undefined ? `${line.name}: ${t("nothing-yet-within").toLowerCase()}` : `${line.name}: ${with_unit(last, line.unit)}`;
    });
    this.canvas.setAttribute("aria-label", `${this.end === undefined ? t("plot-label-following", { label: this.label }) : t("plot-label-paused", { label: this.label })}. ${this.far ? `${moment_text(from)} – ${moment_text(to)}. ` : ""}${lines.join(", ") || t("nothing-yet-within")}`);
  }

  show_legend(lines) {
    const key = lines.map((line) => line.key).join("|");
    if (key === this.legend_key) return;
    this.legend_key = key;
    this.legend.replaceChildren(...(lines.length < 2 ? [] : lines.map((line, i) => {
      const button = h("button", { class: `line${i % kColors}`, onclick: () => {
        if (!this.hidden_lines.delete(line.key)) this.hidden_lines.add(line.key);
        press();
      } }, line.name);
      const press = () => button.setAttribute("aria-pressed", !this.hidden_lines.has(line.key));
      press();
      return button;
    })));
  }

  draw() {
    if (!this.seen || !this.width || document.hidden) return;
    const to = this.end ?? Date.now();
    const from = to - this.span;
    if (this.far) this.kept.want(from, to);
    set_text(this.note, this.far ? this.kept.note : "");
    // Nothing moves by a whole pixel: the picture stays.
    const key = `${Math.floor(to * this.width / this.span)} ${this.span} ${this.series.times.length} ${this.series.times.at(-1)} ${this.cursor} ${this.hidden_lines.size} ${this.far && this.kept.version}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const all = this.far ? this.kept.shown(from, to) : [...this.series.lines.values()];
    this.show_legend(all);
    const lines = all.map((line, i) => ({ ...line, color: this.colors[i % kColors], points: line.points ?? thinned(this.series, line.values, from, to, this.width) }))
      .filter((line) => !this.hidden_lines.has(line.key));
    const [low, high] = range_of(lines);
    const context = this.canvas.getContext("2d");
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    context.font = this.font;
    const x_of = (time) => left + (time - from) * (this.width - left) / this.span;
    const y_of = (value) => 6 + (high - value) * (this.height - bottom - 10) / (high - low);
    this.draw_axes(context, { from, to, low, high, x_of, y_of, unit: lines[0]?.unit });
    context.save();
    context.beginPath();
    context.rect(left, 0, this.width - left, this.height);
    context.clip();
    for (const line of lines) (this.far ? draw_steps : draw_line)(context, line, x_of, y_of);
    context.restore();
    if (this.cursor > left) this.draw_cursor(context, lines, from, x_of, y_of);
  }

  draw_axes(context, { from, to, low, high, x_of, y_of, unit }) {
    context.strokeStyle = this.grid;
    context.fillStyle = this.ink;
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const tick of ticks(low, high, Math.max(2, this.height / 40))) {
      const y = Math.round(y_of(tick)) + 0.5;
      stroke(context, left, y, this.width, y);
      context.fillText(number_text(tick), left - 6, y);
    }
    if (unit) {
      context.textBaseline = "bottom";
      context.fillText(unit_text(unit), left - 6, this.height - 2);
    }
    context.textAlign = "center";
    context.textBaseline = "bottom";
    for (const tick of time_ticks(from, to, Math.max(2, this.width / (this.far ? 75 : 110)))) {
      const x = Math.round(x_of(tick)) + 0.5;
      if (x < left + 30 || x > this.width - 30) continue;
      stroke(context, x, 0, x, this.height - bottom);
      context.fillText(tick_text(tick, this.far), x, this.height - 2);
    }
  }

  draw_cursor(context, lines, from, x_of, y_of) {
    const time = from + (this.cursor - left) * this.span / (this.width - left);
    context.strokeStyle = this.ink;
    stroke(context, this.cursor + 0.5, 0, this.cursor + 0.5, this.height - bottom);
    context.textBaseline = "bottom";
    context.textAlign = this.cursor > this.width - 170 ? "right" : "left";
    const beside = this.cursor + (context.textAlign === "left" ? 8 : -8);
    context.fillStyle = this.ink;
    if (this.far) context.fillText(moment_text(time), beside, 16);
    for (const line of lines) {
      const point = line.points.findLast((each) => each.time <= time);
      if (!point || Number.isNaN(point.value)) continue;
      context.fillStyle = line.color;
      context.beginPath();
      context.arc(this.far ? this.cursor : x_of(point.time), y_of(point.value), 3.5, 0, 7);
      context.fill();
      context.fillText(with_unit(point.value, line.unit), beside, Math.max(this.far ? 32 : 16, y_of(point.value) - 4));
    }
  }

  save() {
    const all = this.end === undefined;
    const to = this.end ?? Date.now();
    const text = this.far ? kept_csv(this.kept.shown(to - this.span, to)) : this.series.csv(all ? undefined : this.end - this.span, all ? undefined : this.end);
    const url = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    h("a", { href: url, download: `${this.file}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
  }
}

/// The lowest and highest of all points.
function bounds_of(lines) {
  let low = Infinity;
  let high = -Infinity;
  for (const line of lines) {
    for (const { value, low: bottom_value = value, high: top_value = value } of line.points) {
      if (bottom_value < low) low = bottom_value;
      if (top_value > high) high = top_value;
    }
  }
  return [low, high];
}

function range_of(lines) {
  const [low, high] = bounds_of(lines);
  if (low > high) return [0, 1];
  const room = (high - low) * 0.08 || Math.max(1, Math.abs(high) * 0.1);
  return [low >= 0 && low - room < 0 ? 0 : low - room, high + room];
}

function stroke(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

function draw_line(context, line, x_of, y_of) {
  context.strokeStyle = context.fillStyle = line.color;
  context.lineWidth = 1.75;
  context.lineJoin = "round";
  context.beginPath();
  let before;
  let step = 0;
  for (const { time, value } of line.points) {
    const gap = time - before;
    if (gap > kGapMs && gap > 10 * step) context.moveTo(x_of(time), y_of(value)); // nothing is known of the time between
    else context.lineTo(x_of(time), y_of(value));
    step = gap;
    before = time;
  }
  context.stroke();
  const last = line.points.at(-1);
  if (!last) return;
  context.beginPath();
  context.arc(x_of(last.time), y_of(last.value), 2.5, 0, 7);
  context.fill();
}

customElements.define("asip-plot", Plot);
