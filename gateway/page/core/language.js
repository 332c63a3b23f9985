// SPDX-License-Identifier: Apache-2.0
// The texts of the page in the language of its reader. Each language is one table, languages/CODE.json, that a translator can edit.

export const kLanguages = { en: "English", de: "Deutsch", es: "Español", fr: "Français", it: "Italiano" };

let texts = {};
let kinds_of_number = new Intl.PluralRules("en");
let counted = new Intl.NumberFormat("en");
export let locale = "en-GB"; // of numbers, times and days

/// From now on the page speaks `language`, by its table.
export function speak(language, table) {
  texts = table;
  locale = language === "en" ? "en-GB" : language;
  kinds_of_number = new Intl.PluralRules(language);
  counted = new Intl.NumberFormat(language, { maximumFractionDigits: 1 });
}

/// How many there are, as it is written.
export const count_text = (count) => counted.format(count);

/// The text of that name with the values in the places of its {names}. Where it has several forms, that for the number `n`.
export function t(name, values = {}) {
  const entry = texts[name] ?? name;
  const text = typeof entry === "string" ? entry : entry[kinds_of_number.select(values.n)] ?? entry.other;
  return text.replace(/\{(\w+)\}/g, (_, key) => (key === "n" ? count_text(values.n) : String(values[key])));
}

/// The same where there may be none of that name: undefined then.
export const known_text = (name, values) => (Object.hasOwn(texts, name) ? t(name, values) : undefined);

/// The language for a reader who wants these, the dearest first: "de" for ["pt-BR", "de-AT", "en"].
export const language_for = (wanted) => wanted.map((each) => String(each).toLowerCase().split("-")[0]).find((each) => Object.hasOwn(kLanguages, each)) ?? "en";
