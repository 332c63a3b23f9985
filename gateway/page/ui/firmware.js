// SPDX-License-Identifier: Apache-2.0
// Loading AsipServices into a board that speaks no ASIP: its agent does it, and says how far it is.
import { loading_of, port_text, speaks_no_asip } from "../core/firmware.js";
import { t } from "../core/language.js";
import { path_of, request } from "../net/bus.js";
import { answer_line, fresh_id, h, Part, set_text, tell } from "./dom.js";
import { status } from "./model.js";

export const kinds = [["", t("find-out")], ["uno", "Uno"], ["nano", "Nano"], ["nano-old", t("nano-until-2018")], ["mega", "Mega 2560"]];

/// Asks the agent of a board to load AsipServices; or what `body` says. The sentence that says how it ended: {kind, text, reason}.
export async function load_firmware(board, body) {
  try {
    const { answer } = await request(`${path_of("boards", board, "load")}?deadline_ms=60000`, { method: "POST", body });
    return { kind: "ok", text: t("sketch-loaded", { sketch: answer?.after?.sketch ?? "AsipServices" }) };
  } catch (problem) {
    if (problem.status === 504) return { kind: "", text: t("takes-longer") };
    return { kind: "refused", text: problem.message, reason: problem.reason };
  }
}

class Firmware extends Part {
  shown() {
    const id = fresh_id("kind");
    this.heading = h("strong", {});
    this.kind = h("select", { id }, kinds.map(([value, text]) => h("option", { value }, text)));
    this.button = h("button", { class: "main", onclick: () => this.load() }, t("load-asipservices"));
    this.form = h("span", { class: "actions" }, h("label", { for: id }, t("which-board"), " "), this.kind, " ", this.button);
    this.bar = h("progress", { max: 100, value: 0, hidden: true, "aria-label": t("loading") });
    this.step = h("span", { role: "status" });
    this.answer = answer_line();
    this.box = h("section", { class: "attention", "aria-label": t("firmware"), hidden: true }, h("p", {}, this.heading, " ", this.form), h("p", {}, this.bar, " ", this.step), h("p", {}, this.answer));
    this.append(this.box);
    this.listen(status, "change", () => this.draw());
    this.draw();
  }

  /// A board as the gateway says it is.
  show(board) {
    this.board = board;
    if (this.isConnected) this.draw();
  }

  draw() {
    const { board } = this;
    const bare = board !== undefined && speaks_no_asip(board);
    const loading = loading_of(board?.description);
    if (bare || loading || this.busy) this.seen = true;
    this.box.hidden = !this.seen || (!bare && !loading && !this.busy && this.answer.textContent === "");
    const at = port_text(board?.description?.link?.path ?? board?.link);
    set_text(this.heading, bare ? at ? t("board-speaks", { at }) : t("board-speaks-no") : "");
    this.form.hidden = !bare || !status.may_label || Boolean(this.busy);
    this.bar.hidden = !loading && !this.busy;
    if (loading) this.bar.value = loading.percent;
    else this.bar.removeAttribute("value"); // it moves, and shows no part
    set_text(this.step, loading?.text ?? (this.busy ? t("agent-asked") : ""));
  }

  async load() {
    this.busy = true;
    set_text(this.answer, "");
    this.draw();
    const { kind, text } = await load_firmware(this.name, this.kind.value ? { board: this.kind.value } : {});
    this.busy = false;
    tell(this.answer, kind, text);
    if (this.isConnected) this.draw();
  }
}

customElements.define("asip-firmware", Firmware);
