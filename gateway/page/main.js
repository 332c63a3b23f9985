// SPDX-License-Identifier: Apache-2.0
// Which screen is shown.
import "./ui/board.js";
import "./ui/boards.js";
import "./ui/shell.js";
import "./ui/system.js";
import { h } from "./ui/dom.js";
import { status } from "./ui/model.js";

const main = document.getElementById("main");
const screens = [
  [/^$/, () => ["Boards", document.createElement("asip-boards")]],
  [/^board\/([^/]+)$/, (name) => [name, document.createElement("asip-board").begin(name)]],
  [/^history$/, () => ["History", h("div", {}, h("h1", { tabindex: "-1" }, "History"), document.createElement("asip-history").begin("api/history", true))]],
  [/^bus$/, () => ["Bus", document.createElement("asip-system")]],
];

function sign_in() {
  return ["Sign in", h("div", { class: "sign-in" }, h("h1", { tabindex: "-1" }, "Sign in"),
    h("p", {}, "This gateway does not know this browser. On the machine that it runs on, type"), h("pre", {}, "asipctl open"),
    h("p", {}, "and open the address that is printed. It works once, for 30 seconds."))];
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text; // "%" that somebody typed
  }
}

function screen_of(path) {
  if (status.problem?.status === 401) return sign_in();
  for (const [pattern, make] of screens) {
    const match = pattern.exec(path);
    if (match) return make(...match.slice(1).map(decoded));
  }
  return ["Not found", h("div", {}, h("h1", { tabindex: "-1" }, "There is no such page"), h("a", { href: "#/" }, "All boards"))];
}

let path;
function show(first = false) {
  const wanted = location.hash.replace(/^#\/?/, "");
  if (wanted === "main") return main.focus(); // the link that skips the header
  path = wanted;
  const [title, screen] = screen_of(path);
  main.replaceChildren(screen);
  document.title = `${title} – ASIP`;
  for (const link of document.querySelectorAll("nav a")) {
    const target = link.getAttribute("href").slice(2);
    const here = target === path || (target === "" && path.startsWith("board/"));
    if (here) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  if (!first) (screen.querySelector("h1[tabindex]") ?? main).focus({ preventScroll: true });
  scrollTo(0, 0);
}

addEventListener("hashchange", () => show());
let signed_out = false;
status.addEventListener("change", () => {
  const out = status.problem?.status === 401;
  if (out !== signed_out) show();
  signed_out = out;
});
show(true);
