// SPDX-License-Identifier: Apache-2.0
// The language of this browser: what was chosen in the page, else what the browser prefers.
import { kLanguages, language_for, speak } from "../core/language.js";

const kKept = "asip-language";

function kept() {
  try {
    return localStorage.getItem(kKept);
  } catch {
    return null; // nothing may be kept here
  }
}

export const chosen = () => (Object.hasOwn(kLanguages, kept() ?? "") ? kept() : language_for(navigator.languages));

/// Loads its table. Where that fails the page shows the names of its texts, which are English words.
export async function begin() {
  const language = chosen();
  document.documentElement.lang = language;
  const table = await fetch(new URL(`../languages/${language}.json`, import.meta.url)).then((response) => (response.ok ? response.json() : {})).catch(() => ({}));
  speak(language, table);
}

/// The page begins anew in it.
export function choose(language) {
  try {
    localStorage.setItem(kKept, language);
  } catch { /* the browser's own stays */ }
  location.reload();
}
