// SPDX-License-Identifier: Apache-2.0
// What can be done with the boards that are selected in the table: stop them, resume them, label them, send them a command.
import { command_order } from "../core/form.js";
import { parse_assignments } from "../core/labels.js";
import { t } from "../core/language.js";
import { for_each_board, lists_of, many_text, result_of } from "../core/many.js";
import { service_text, title_text, words } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import "./command.js";
import { answer_line, field, fresh_id, h, muted, Part, set_text } from "./dom.js";
import { boards, status } from "./model.js";

class Selection extends Part {
  /// `picked`: the names; `clear` is called when the selection is given up.
  begin(picked, clear) {
    Object.assign(this, { picked, clear });
    return this;
  }

  shown() {
    this.setAttribute("role", "region");
    this.setAttribute("aria-label", t("selected-boards"));
    this.count = h("strong", {});
    this.answer = answer_line();
    const button = (text, work, more = {}) => h("button", { onclick: work, ...more }, text);
    this.stops = [button(t("stop"), () => this.ask_all("stop"), { class: "stop" }), button(t("resume"), () => this.ask_all("resume"))];
    this.send = button(t("send"), () => this.open(() => this.send_form()));
    this.labels = button(t("label"), () => this.open(() => this.label_form()));
    this.panel = h("div", { class: "selection-panel" });
    this.append(h("div", { class: "toolbar" }, this.count, this.stops, this.send, this.labels, button(t("clear"), () => this.clear()), this.answer), this.panel);
    this.listen(status, "change", () => this.show());
    this.show();
  }

  show() {
    this.hidden = this.picked.size === 0;
    set_text(this.count, t("n-boards-selected", { n: this.picked.size }));
    this.stops[0].hidden = !status.may_stop;
    this.stops[1].hidden = status.you.resume !== true;
    this.send.hidden = !status.may_command;
    this.labels.hidden = !status.may_label;
    if (this.hidden) this.open(() => "");
  }

  open(make) {
    this.tell("", "");
    this.panel.replaceChildren(make());
    this.panel.querySelector("input, select")?.focus();
  }

  async each(task) {
    const names = [...this.picked];
    const result = await for_each_board(names, task, { progress: (ended) => this.tell("", t("ended-all", { ended, all: names.length })) });
    return { ...result, status: result.failed.length === 0 ? "ok" : "error", kind: result.failed.length === 0 ? "ok" : "error", text: many_text(result) };
  }

  /// Stops or resumes them: however many they are, the gateway is asked once.
  async ask_all(what) {
    const all = { done: 0, failed: [] };
    this.tell("", t("asked"));
    for (const names of lists_of(this.picked)) {
      const result = await request(path_of(what), { method: "POST", body: { boards: names } }).then(
        (answer) => result_of(names, answer), (problem) => ({ done: 0, failed: names.map((name) => [name, problem.message]) }));
      all.done += result.done;
      all.failed.push(...result.failed);
    }
    this.tell(all.failed.length === 0 ? "ok" : "error", many_text(all));
  }

  label_form() {
    const input = h("input", { id: fresh_id("label"), type: "text", autocomplete: "off", placeholder: t("room-lab") });
    const apply = async (event) => {
      event.preventDefault();
      const labels = parse_assignments(input.value);
      if (!labels) return this.tell("refused", t("type-label"));
      const { kind, text } = await this.each(async (name) => {
        await request(path_of("boards", name, "labels"), { method: "POST", body: { labels } });
      });
      return this.tell(kind, text);
    };
    return h("form", { "aria-label": t("label-selected"), onsubmit: apply },
      field(t("label-within"), input, "text"), h("button", { class: "main" }, t("label-them")));
  }

  /// The services that all of them have; where there is none, those that any has.
  services() {
    const rows = [...this.picked].map((name) => boards.catalogue.rows.get(name)).filter(Boolean);
    const counts = new Map();
    for (const row of rows) for (const service of row.services) counts.set(service, (counts.get(service) ?? 0) + 1);
    const all = [...counts].filter(([, count]) => count === rows.length).map(([name]) => name);
    return (all.length > 0 ? all : [...counts.keys()]).sort();
  }

  send_form() {
    const ids = [fresh_id("service"), fresh_id("command")];
    const service = h("select", { id: ids[0], onchange: () => choose_service() }, this.services().map((name) => h("option", { value: name }, service_text(name))));
    const command = h("select", { id: ids[1], onchange: () => choose_command() });
    const form = h("div", {});
    let model;
    const choose_command = () => {
      const ask = (args) => this.each(async (name) => {
        if (!boards.catalogue.rows.get(name)?.services.includes(service.value)) return t("no-service", { service: service_text(service.value) });
        await request(path_of("boards", name, "services", service.value, "commands", command.value), { method: "POST", body: args });
        return undefined;
      });
      form.replaceChildren(document.createElement("asip-command").begin("", { name: service.value }, model, command.value, ask));
    };
    const choose_service = async () => {
      const board = [...this.picked].find((name) => boards.catalogue.rows.get(name)?.services.includes(service.value));
      const known = board && await request(path_of("boards", board, "services", service.value)).catch(() => undefined);
      model = known?.model;
      const names = model ? command_order(model) : [];
      command.replaceChildren(...names.map((name) => h("option", { value: name }, title_text(model.commands[name].title ?? words(name)))));
      if (names.length > 0) choose_command();
      else form.replaceChildren(muted(t("no-model")));
    };
    choose_service();
    return h("div", { class: "send-many" }, h("div", { class: "toolbar" }, h("label", { for: ids[0] }, t("service")), service, h("label", { for: ids[1] }, t("command")), command), form);
  }
}

customElements.define("asip-selection", Selection);
