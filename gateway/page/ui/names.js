// SPDX-License-Identifier: Apache-2.0
// What people call a board, its services and its pins, and its labels. The board's agent keeps them.
import { changed_labels, changed_names, labels_text } from "../core/labels.js";
import { t } from "../core/language.js";
import { service_text, title_of_service } from "../core/text.js";
import { path_of, request } from "../net/bus.js";
import { answer_line, field, fresh_id, h, Part, tell } from "./dom.js";
import { status } from "./model.js";

/// Asks the agent of a board to keep `change`: {labels, names}. The sentence that says how it ended: {kind, text}.
export async function keep_labels(board, change) {
  try {
    await request(path_of("boards", board, "labels"), { method: "POST", body: change });
    return { kind: "ok", text: t("kept") };
  } catch (problem) {
    return { kind: "refused", text: problem.message, status: problem.status };
  }
}

class Names extends Part {
  shown() {
    this.fields = h("div", { class: "name-fields" });
    this.answer = answer_line();
    this.box = h("details", { hidden: true }, h("summary", {}, t("names-labels")),
      h("form", { "aria-label": t("names-labels"), onsubmit: (event) => { event.preventDefault(); this.save(); } }, this.fields,
        h("span", { class: "actions" }, h("button", { class: "main" }, t("save"))), this.answer));
    this.append(this.box);
    this.listen(status, "change", () => this.allow());
    this.allow();
    if (this.board) this.build();
  }

  allow() { this.box.hidden = !status.may_label || !this.board?.description; }

  /// A board as the gateway says it is. What is being typed stays.
  show(board) {
    this.board = board;
    if (!this.isConnected) return;
    this.allow();
    const key = JSON.stringify([board.labels, board.names?.services, board.services]);
    if (key === this.shown_key || this.box.contains(document.activeElement)) return;
    this.shown_key = key;
    this.build();
  }

  build() {
    const { labels = {}, names = {}, description } = this.board;
    const asked = (title, value, more = {}) => {
      const input = h("input", { id: fresh_id("name"), type: "text", autocomplete: "off", value, ...more });
      this.fields.append(field(title, input, "text"));
      return input;
    };
    this.fields.replaceChildren();
    this.own = asked(t("name-board"), labels.name ?? "", { maxlength: 63, placeholder: this.name });
    const services = description?.services ?? [];
    this.services = new Map(services.map((service) => [service.name,
      asked(t("name-service", { service: service_text(service.name) }), names.services?.[service.name] ?? "", { maxlength: 63, placeholder: service.name === "io" ? t("pins") : title_of_service(service) })]));
    this.labels = asked(t("labels-commas"), labels_text(labels), { placeholder: "room=lab, shelf=2" });
  }

  async save() {
    const entered = new Map([...this.services].map(([name, input]) => [name, input.value.trim()]));
    const labels = changed_labels(this.board.labels ?? {}, this.labels.value, this.own.value.trim());
    const services = changed_names(this.board.names?.services ?? {}, entered);
    const change = { ...(Object.keys(labels).length > 0 && { labels }), ...(Object.keys(services).length > 0 && { names: { services } }) };
    if (Object.keys(change).length === 0) return void this.tell({ kind: "ok", text: t("nothing-was-changed") });
    this.tell({ kind: "", text: t("waiting-agent") });
    const answer = await keep_labels(this.name, change);
    this.shown_key = undefined;
    this.tell(answer);
  }

  tell({ kind, text }) {
    tell(this.answer, kind, text);
  }
}

customElements.define("asip-names", Names);
