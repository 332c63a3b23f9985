// SPDX-License-Identifier: Apache-2.0
// Which screen is shown.
import "./add_board.js";
import "./board.js";
import "./boards.js";
import { class_screen, join_screen, lend_screen } from "./class.js";
import { is_kiosk } from "./dashboard.js";
import "./shell.js";
import "./settings.js";
import { attention_of, title_badge } from "../core/attention.js";
import { t } from "../core/language.js";
import { base, request } from "../net/bus.js";
import { command_line, h, set_text } from "./dom.js";
import { boards, status } from "./model.js";

const main = document.getElementById("main");
const kDocs = "https://github.com/asip/asip-service-bus/blob/main/docs/";
const kPage = "gateway.md#the-page";
// Address, what shows it with its title, and the page of the documentation that is about it.
const screens = [
  [/^(?:\?(.*))?$/, (query) => [t("boards"), document.createElement("asip-boards").begin(query)], kPage],
  [/^add(?:\/([^/]+))?$/, (name) => [t("add-board"), document.createElement("asip-add-board").begin(name ?? "")], "asipctl.md#boards-from-the-box"],
  [/^board\/([^/]+)$/, (name) => [name, document.createElement("asip-board").begin(name)], kPage],
  [/^dashboards$/, () => [t("dashboards"), document.createElement("asip-dashboards")], "dashboards.md"],
  [/^dashboard\/([^/?]+)(?:\?.*)?$/, (name) => [name, document.createElement("asip-dashboard").begin(name)], "dashboards.md"],
  [/^class$/, class_screen, "start-in-class.md"],
  [/^join(?:\/([^/]+))?$/, (code) => join_screen(code ?? ""), "start-in-class.md"],
  [/^lend$/, lend_screen, "gateway.md#boards-in-the-computer-of-a-browser"],
  [/^history$/, () => [t("history"), h("div", {}, h("h1", { tabindex: "-1" }, t("history")), document.createElement("asip-history").begin("api/history", true))], "service-bus.md#who-did-what"],
  [/^(?:settings|bus)$/, () => [t("settings"), document.createElement("asip-settings")], "gateway.md#boards-in-other-systems"],
];

// The token becomes a code that works once, and the code a cookie: the token itself is kept nowhere.
async function enter(token, answer) {
  try {
    const { code } = await request("api/codes", { method: "POST", body: {}, headers: { Authorization: `Bearer ${token}` } });
    location.assign(new URL(`?code=${code}${location.hash}`, base));
  } catch (problem) {
    set_text(answer, problem.status === 401 ? t("gateway-does") : problem.message);
  }
}

function sign_in() {
  const token = h("input", { id: "token", type: "password", autocomplete: "current-password", required: true });
  const answer = h("output", { class: "answer refused", "aria-live": "polite" });
  return [t("sign"), h("div", { class: "sign-in" }, h("h1", { tabindex: "-1" }, t("sign")), document.createElement("asip-join").begin(""),
    h("p", {}, t("gateway-shows")),
    command_line("asip-gateway token ROLE NAME --tokens FILE"),
    h("form", { onsubmit: (event) => { event.preventDefault(); enter(token.value.trim(), answer); } },
      h("label", { for: "token" }, t("token")), " ", token, " ", h("button", { class: "main" }, t("sign")), h("p", {}, answer)))];
}

const link_is_over = () => [t("not-valid"), h("div", {}, h("h1", { tabindex: "-1" }, t("link-not")),
  h("p", {}, t("ask-person")))];

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text; // "%" that a user typed
  }
}

function screen_of(path) {
  if (status.refused && status.problem.status === 401 && (path.startsWith("join") || status.problem.reason)) return [...join_screen(/^join\/(.+)$/.exec(path)?.[1] ?? "", status.problem), "start-in-class.md"];
  if (status.refused) return [...(status.problem.status === 401 ? sign_in() : link_is_over()), "gateway.md#who-may-do-what"];
  if (is_kiosk()) return [status.you.dashboard, document.createElement("asip-dashboard").begin(status.you.dashboard)];
  if (base.pathname.includes("/kiosk/") && !status.now) return ["", h("div", {})]; // what the link shows is not known yet
  for (const [pattern, make, help] of screens) {
    const match = pattern.exec(path);
    if (match) return [...make(...match.slice(1).map((part) => (path.startsWith("?") || part === undefined ? part : decoded(part)))), help];
  }
  return [t("not-found"), h("div", {}, h("h1", { tabindex: "-1" }, t("there-no")), h("a", { href: "#/" }, t("all-boards")))];
}

let path;
let screen_title = "";
function show_title() { document.title = `${title_badge(attention_of(boards.catalogue.rows.values()))}${screen_title} – ASIP`; }
boards.addEventListener("change", show_title);

function show(first = false) {
  const wanted = location.hash.replace(/^#\/?/, "");
  if (wanted === "main") return main.focus(); // the link that skips the header
  path = wanted;
  const [title, screen, help = kPage] = screen_of(path);
  main.replaceChildren(screen);
  document.getElementById("help").href = kDocs + help;
  document.body.classList.toggle("bare", is_kiosk() || /^dashboard\/.*\?full/.test(path));
  document.body.classList.toggle("kiosk", is_kiosk());
  screen_title = title;
  show_title();
  for (const link of document.querySelectorAll("nav a")) {
    const target = link.getAttribute("href").slice(2);
    const here = target === path || (target === "" && (/^(?:board\/|add|\?)/.test(path))) || (target === "dashboards" && path.startsWith("dashboard/"));
    if (here) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  if (!first) (screen.querySelector("h1[tabindex]") ?? main).focus({ preventScroll: true });
  scrollTo(0, 0);
}

addEventListener("hashchange", () => show());
let signed_out = false;
let link_of; // what the link shows, as far as is known
status.addEventListener("change", () => {
  const shown = base.pathname.includes("/kiosk/") && status.now ? status.you.dashboard ?? "" : status.you.dashboard;
  if (status.refused !== signed_out || (!status.problem && shown !== link_of)) show(status.refused === signed_out);
  if (!status.problem) link_of = shown;
  signed_out = status.refused;
  document.querySelector("nav").hidden = signed_out;
});
show(true);
