// SPDX-License-Identifier: Apache-2.0
// A class: the teacher opens a lesson and sees its pupils, a pupil joins by a code and sees whose board this is.
import { answer_text } from "../core/form.js";
import { blinks, light_of } from "../core/identify.js";
import { t } from "../core/language.js";
import { qr_of } from "../core/qr.js";
import { clock_text, time_of } from "../core/text.js";
import { base, bus, path_of, properties_of, request } from "../net/bus.js";
import { fresh_id, h, Part, set_text, state_mark, svg } from "./dom.js";
import { boards, status } from "./model.js";

const kAgainMs = 2000;
const kBlinkMs = 250;
const kMinutes = [45, 60, 90, 180];
const kTheirs = "*"; // no label is called so

const minute_text = (iso) => clock_text(time_of(iso)).slice(0, 5);
const pause = (ms) => new Promise((done) => { setTimeout(done, ms); });

/// Blinks the light of a board, on a press; returns a sentence.
async function identify(name) {
  const [board, properties] = await Promise.all([request(path_of("boards", name)), properties_of(name)]);
  const light = light_of(board, properties);
  if (light.refused) return light.refused;
  const { values = {} } = light.output ? await request(path_of("boards", name, "values")) : {};
  for (const [command, args] of blinks(light, values[`io/${light.pin}`]?.value === true)) {
    const answer = await bus.command(name, "io", command, args).answer;
    if (answer.status !== "ok") return answer_text(answer).text;
    await pause(kBlinkMs);
  }
  return t("lesson-blinked");
}

/// A button that identifies a board, and says in `output` what becomes of it.
function identifier(board, output) {
  const button = h("button", { "aria-label": `${t("lesson-identify")} ${board()}`, onclick: async () => {
    button.disabled = true;
    set_text(output, t("lesson-blinking"));
    set_text(output, await identify(board()).catch((problem) => problem.message));
    button.disabled = false;
  } }, t("lesson-identify"));
  return button;
}

/// The browser has other rights from now on: everything is asked for anew.
function go_anew(hash) {
  bus.anew();
  location.hash = hash;
  location.reload();
}

async function leave() {
  await request("api/session", { method: "DELETE", body: {} }).catch(() => undefined);
  go_anew("#/");
}

function picture_of(address) {
  const rows = qr_of(address);
  if (!rows) return "";
  const size = rows.length + 8; // four light ones around it
  const path = rows.flatMap((row, y) => row.map((dark, x) => (dark ? `M${x + 4} ${y + 4}h1v1h-1z` : ""))).join("");
  return svg("svg", { viewBox: `0 0 ${size} ${size}`, class: "qr", role: "img", "aria-label": address }, svg("path", { d: path }));
}

class Classes extends Part {
  shown() {
    this.shown_lessons = new Map();
    this.list = h("div", {});
    this.answer = h("output", { class: "answer", "aria-live": "polite" });
    this.which = h("select", { id: fresh_id("boards") });
    const minutes = h("select", { id: fresh_id("minutes") }, kMinutes.map((each) => h("option", { value: each }, t("lesson-minutes", { n: each }))));
    this.form = h("form", { class: "open-lesson", "aria-label": t("lesson-open"), onsubmit: (event) => { event.preventDefault(); this.open(this.which.value, Number(minutes.value)); } },
      h("div", { class: "field" }, h("label", { for: this.which.id }, t("boards")), this.which),
      h("div", { class: "field" }, h("label", { for: minutes.id }, t("lesson-how-long")), minutes), this.button = h("button", { class: "main" }, t("lesson-open")));
    this.note = h("p", { class: "muted" });
    this.append(h("h1", { tabindex: "-1" }, t("lesson-class")), this.list, this.note, this.form, this.answer);
    this.listen(boards, "change", () => this.show());
    this.listen(status, "change", () => this.load());
    this.every(kAgainMs, () => { if (!document.hidden) this.load(); });
    this.show();
    this.load();
  }

  get may() { return status.you.arrange === true; }

  show() {
    const there = [...boards.catalogue.rows.values()].filter((row) => !["lost", "offline", "no-asip"].includes(row.state));
    const labels = new Map();
    for (const row of there) for (const [key, value] of Object.entries(row.tags)) if (key !== "name") labels.set(value === "" ? key : `${key}=${value}`, (labels.get(value === "" ? key : `${key}=${value}`) ?? 0) + 1);
    const lend = status.you.lend === true;
    const offers = [...(there.length > 0 || !lend ? [["", t("lesson-all", { n: there.length })]] : []), ...[...labels].sort().map(([label, count]) => [label, `${label} (${count})`]),
      ...(lend ? [[kTheirs, t("lesson-theirs")]] : [])];
    if (JSON.stringify(offers) !== this.offers) {
      const { value } = this.which;
      this.offers = JSON.stringify(offers);
      this.which.replaceChildren(...offers.map(([label, text]) => h("option", { value: label }, text)));
      if (offers.some(([label]) => label === value)) this.which.value = value;
    }
    this.form.hidden = !this.may;
    this.button.disabled = offers[0][0] === "" && there.length === 0;
    set_text(this.note, !this.may ? (status.now ? t("lesson-not-yours") : "") : this.button.disabled ? t("lesson-no-board") : t("lesson-intro"));
    for (const lesson of this.shown_lessons.values()) lesson.show();
  }

  async open(labels, minutes) {
    try {
      await request("api/lessons", { method: "POST", body: { ...(labels === kTheirs ? { lend: true } : labels ? { labels } : { boards: ["*"] }), minutes } });
      this.tell("");
    } catch (problem) {
      this.tell(problem.message);
    }
    await this.load();
  }

  tell(text) {
    this.answer.className = "answer refused";
    set_text(this.answer, text);
  }

  async load() {
    if (!this.may) return this.show();
    const { items } = await request("api/lessons").catch(() => ({}));
    if (!items || !this.isConnected) return undefined;
    const known = this.shown_lessons;
    this.shown_lessons = new Map(items.map((each) => [each.id, known.get(each.id) ?? document.createElement("asip-lesson").begin(() => this.load())]));
    for (const [id, element] of known) if (!this.shown_lessons.has(id)) element.remove();
    for (const each of items) {
      const element = this.shown_lessons.get(each.id);
      element.lesson = each;
      if (element.isConnected) element.show();
      else this.list.append(element);
    }
    return this.show();
  }
}

class LessonCard extends Part {
  begin(changed) {
    this.changed = changed;
    return this;
  }

  shown() {
    const { code, path } = this.lesson;
    this.rows = new Map();
    this.state = h("p", { role: "status" });
    this.answer = h("output", { class: "answer", "aria-live": "polite" });
    this.seats = h("ul", { class: "link-list seats" });
    const local = ["localhost", "127.0.0.1", "[::1]"].includes(location.hostname);
    this.append(h("section", { class: "card lesson", "aria-label": code },
      h("div", { class: "lesson-code" }, h("div", {}, h("p", {}, t("lesson-type-at", { address: `${base.protocol === "https:" ? "https://" : ""}${base.host}${base.pathname}join` })), h("p", { class: "class-code" }, code), this.state, local && h("p", { class: "muted" }, t("lesson-local"))),
        picture_of(base.href + path)),
      h("p", { class: "lesson-tools" }, h("button", { class: "stop", onclick: () => this.ask("api/stop", this.names) }, t("lesson-stop")), h("button", { onclick: () => this.ask("api/resume", this.names) }, t("lesson-resume")),
        h("button", { onclick: () => this.ask(path_of("lessons", this.lesson.id), {}, "DELETE") }, t("lesson-end")), this.answer), this.seats));
    this.show();
  }

  get names() { return { boards: this.lesson.boards.map((each) => each.board).filter((name) => boards.catalogue.rows.has(name)) }; }

  async ask(path, body, method = "POST") {
    try {
      await request(path, { method, body });
      set_text(this.answer, "");
    } catch (problem) {
      set_text(this.answer, problem.message);
    }
    await this.changed();
  }

  row_of(board) {
    const take = (keep) => () => this.ask(path_of("lessons", this.lesson.id, "take"), { board, keep });
    const row = { who: h("strong", {}), state: h("span", {}), since: h("small", { class: "muted" }), said: h("small", { role: "status" }),
      take: h("button", { "aria-label": `${t("lesson-take")} ${board}`, onclick: take(true) }, t("lesson-take")), free: h("button", { "aria-label": `${t("lesson-free")} ${board}`, onclick: take(false) }, t("lesson-free")) };
    this.seats.append(h("li", {}, row.who, h("a", { href: `#/board/${encodeURIComponent(board)}` }, board), row.state, row.since,
      h("span", { class: "actions" }, identifier(() => board, row.said), row.take, row.free), row.said));
    return row;
  }

  show() {
    const list = this.lesson.boards;
    set_text(this.state, t("lesson-until", { time: minute_text(this.lesson.until), pupils: list.filter((each) => each.pupil).length, count: list.length }));
    for (const { board, pupil, since, kept } of list) {
      if (!this.rows.has(board)) this.rows.set(board, this.row_of(board));
      const row = this.rows.get(board);
      set_text(row.who, pupil ?? (kept ? t("lesson-is-yours") : t("lesson-is-free")));
      row.who.className = pupil ? "" : "muted";
      set_text(row.since, since ? t("lesson-since", { time: minute_text(since) }) : "");
      row.take.hidden = kept;
      row.free.hidden = !pupil && !kept;
      const catalogued = boards.catalogue.rows.get(board);
      const state = catalogued?.reason === "latched" ? "latched" : catalogued?.state;
      if (state !== row.shown) {
        row.shown = state;
        row.state.replaceChildren(state ? state_mark(state) : "");
      }
    }
  }
}

/// A form for the code of a class.
class Join extends Part {
  begin(code) {
    this.code = code;
    return this;
  }

  shown() {
    const code = h("input", { id: fresh_id("code"), type: "text", class: "class-code", autocomplete: "off", autocapitalize: "characters", spellcheck: "false", maxlength: 12, size: 8, required: true, value: this.code });
    this.answer = h("output", { class: "answer refused", "aria-live": "polite" });
    this.append(h("form", { "aria-label": t("lesson-join-class"), onsubmit: (event) => { event.preventDefault(); this.join(code.value); } },
      h("div", { class: "field" }, h("label", { for: code.id }, t("lesson-code")), code, " ", h("button", { class: "main" }, t("lesson-join"))), h("p", {}, this.answer)));
  }

  async join(code) {
    try {
      const { board, lend } = await request("api/join", { method: "POST", body: { code } });
      go_anew(lend ? "#/lend" : `#/board/${encodeURIComponent(board)}`);
    } catch (problem) {
      set_text(this.answer, problem.message);
    }
  }
}

/// What a pupil sees above every screen.
class Pupil extends Part {
  shown() {
    this.text = h("span", { role: "status" });
    this.said = h("small", { role: "status" });
    const board = () => status.you.lesson?.board ?? "";
    this.setAttribute("role", "region");
    this.setAttribute("aria-label", t("lesson-class"));
    this.hidden = true;
    this.lend = h("a", { class: "button", href: "#/lend" }, t("lesson-lend"));
    this.append(this.text, h("span", { class: "actions" }, this.lend, identifier(board, this.said), h("button", { onclick: leave }, t("lesson-leave"))), this.said);
    this.listen(status, "change", () => {
      const { lesson } = status.you;
      this.hidden = !lesson;
      this.lend.hidden = status.you.lend !== true;
      if (lesson) set_text(this.text, t("lesson-pupil", { pupil: lesson.pupil, board: lesson.board, time: minute_text(lesson.until) }));
    });
  }
}

/// `problem`: why this browser has no rights; it may be that its lesson is over.
export function join_screen(code, problem) {
  const over = problem?.reason === "lesson-over" && [h("p", { role: "alert" }, t("lesson-was")), h("p", {}, h("button", { onclick: leave }, t("lesson-over")))];
  return [t("lesson-join-class"), h("div", { class: "sign-in" }, h("h1", { tabindex: "-1" }, t("lesson-join-class")), over, document.createElement("asip-join").begin(code))];
}
export function lend_screen() {
  const end = h("span", {});
  import("../cable/cable.js").then(({ offer }) => offer(end, false));
  return [t("lesson-lend"), h("div", {}, h("h1", { tabindex: "-1" }, t("lesson-lend")), end)];
}
export const class_screen = () => [t("lesson-class"), document.createElement("asip-class")];
export const class_link = () => h("a", { class: "button", href: "#/class" }, t("lesson-class"));

customElements.define("asip-class", Classes);
customElements.define("asip-lesson", LessonCard);
customElements.define("asip-join", Join);
customElements.define("asip-pupil", Pupil);
