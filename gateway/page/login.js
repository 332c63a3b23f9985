// SPDX-License-Identifier: Apache-2.0
// Between the address of a log-in and the page: goes on by itself, or asks. The part behind # is not sent to the gateway.
import { t } from "./core/language.js";
import { begin } from "./net/language.js";

const { go, stay, why } = Object.fromEntries(["go", "stay", "why"].map((id) => [id, document.getElementById(id)]));
go.href += location.hash;
if (go.dataset.atOnce !== undefined) location.replace(go.href);
else {
  await begin();
  const { name } = go.dataset;
  const other = stay.dataset.name;
  const ask = document.querySelector("h1");
  ask.textContent = document.title = t("sign-in-as-name", { name });
  why.textContent = t("other-signs-in", { name, other });
  stay.textContent = t("stay-other", { other });
  go.textContent = t("sign-in-name", { name });
}
