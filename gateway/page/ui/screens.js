// SPDX-License-Identifier: Apache-2.0
// Which screen is shown.
import "./ui/add_board.js";
import "./ui/board.js";
import "./ui/boards.js";
import { is_kiosk } from "./ui/dashboard.js";
import "./ui/shell.js";
import "./ui/settings.js";
import { attention_of, title_badge } from "./core/attention.js";
import { base, request } from "./net/bus.js";
import { command_line, h, set_text } from "./ui/dom.js";
import { boards, status } from "./ui/model.js";

const main = document.getElementById("main");
const kDocs = "https://github.com/asip/asip-service-bus/blob/main/docs/";
const kPage = "gateway.md#the-page";
// Address, what shows it with its title, and the page of the documentation that is about it.
const screens = [
  [/^(?:\?(.*))?$/, (query) => ["Boards", document.createElement("asip-boards").begin(query)], kPage],
  [/^add(?:\/([^/]+))?$/, (name) => ["Add board", document.createElement("asip-add-board").begin(name ?? "")], "asipctl.md#boards-from-the-box"],
  [/^board\/([^/]+)$/, (name) => [name, document.createElement("asip-board").begin(name)], kPage],
  [/^dashboards$/, () => ["Dashboards", document.createElement("asip-dashboards")], "dashboards.md"],
  [/^dashboard\/([^/?]+)(?:\?.*)?$/, (name) => [name, document.createElement("asip-dashboard").begin(name)], "dashboards.md"],
  [/^history$/, () => ["History", h("div", {}, h("h1", { tabindex: "-1" }, "History"), document.createElement("asip-history").begin("api/history", true))], "service-bus.md#who-did-what"],
  [/^(?:settings|bus)$/, () => ["Settings", document.createElement("asip-settings")], "gateway.md#boards-in-other-systems"],
];

// The token becomes a code that works once, and the code a cookie: the token itself is kept nowhere.
async function enter(token, answer) {
  try {
    const { code } = await request("api/codes", { method: "POST", body: {}, headers: { Authorization: `Bearer ${token}` } });
    location.assign(new URL(`?code=${code}${location.hash}`, base));
  } catch (problem) {
    set_text(answer, problem.status === 401 ? "The gateway does not know this token, or it has expired." : problem.message);
  }
}

function sign_in() {
  const token = h("input", { id: "token", type: "password", autocomplete: "current-password", required: true });
  const answer = h("output", { class: "answer refused", "aria-live": "polite" });
  return ["Sign in", h("div", { class: "sign-in" }, h("h1", { tabindex: "-1" }, "Sign in"),
    h("p", {}, "This gateway shows its boards to users who have a token. A token is made on the gateway's machine, by"),
    command_line("asip-gateway token ROLE NAME --tokens FILE"),
    h("form", { onsubmit: (event) => { event.preventDefault(); enter(token.value.trim(), answer); } },
      h("label", { for: "token" }, "Token"), " ", token, " ", h("button", { class: "main" }, "Sign in"), h("p", {}, answer)))];
}

const link_is_over = () => ["Not valid", h("div", {}, h("h1", { tabindex: "-1" }, "This link is not valid any more"),
  h("p", {}, "Ask the person from whom you have it for another one."))];

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text; // "%" that a user typed
  }
}

function screen_of(path) {
  if (status.refused) return [...(status.problem.status === 401 ? sign_in() : link_is_over()), "gateway.md#who-may-do-what"];
  if (is_kiosk()) return [status.you.dashboard, document.createElement("asip-dashboard").begin(status.you.dashboard)];
  if (base.pathname.includes("/kiosk/") && !status.now) return ["", h("div", {})]; // what the link shows is not known yet
  for (const [pattern, make, help] of screens) {
    const match = pattern.exec(path);
    if (match) return [...make(...match.slice(1).map((part) => (path.startsWith("?") || part === undefined ? part : decoded(part)))), help];
  }
  return ["Not found", h("div", {}, h("h1", { tabindex: "-1" }, "There is no such page"), h("a", { href: "#/" }, "All boards"))];
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
