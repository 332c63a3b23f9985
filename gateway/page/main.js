// SPDX-License-Identifier: Apache-2.0
// The language first, then all that speaks it.
import { kLanguages, t } from "./core/language.js";
import { begin, chosen, choose } from "./net/language.js";

await begin();
for (const each of document.querySelectorAll("[data-text]")) each.textContent = t(each.dataset.text);
document.querySelector("nav").setAttribute("aria-label", t("pages"));
const choice = document.getElementById("language");
choice.setAttribute("aria-label", t("language"));
choice.append(...Object.entries(kLanguages).map(([code, name]) => Object.assign(document.createElement("option"), { value: code, lang: code, textContent: name })));
choice.value = chosen();
choice.onchange = () => choose(choice.value);
await import("./ui/screens.js");
