// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import test from "node:test";
import { kLanguages, language_for, speak, t } from "../../../gateway/page/core/language.js";
import { asked_text } from "../../../gateway/page/core/asked.js";
import { button_text, words_of_error } from "../../../gateway/page/core/form.js";
import { argument_text, choice_text, counter_text, named, title_of_service, title_text, with_unit, words } from "../../../gateway/page/core/text.js";

const page = new URL("../../../gateway/page/", import.meta.url);
const read = (path) => readFileSync(new URL(path, page), "utf8");
const vector = (name) => JSON.parse(readFileSync(new URL(`../../vectors/${name}.json`, import.meta.url)));
const tables = Object.fromEntries(readdirSync(new URL("languages/", page)).map((file) => [file.replace(".json", ""), JSON.parse(read(`languages/${file}`))]));
const sources = read("files.txt").trim().split("\n").filter((file) => file.endsWith(".js"))
  .map((file) => [file, read(file).replace(/^\s*\/\/.*$|\s+\/\/ [^"'`\n]*$/gm, "")]);
const models = readdirSync(new URL("../../../services/", import.meta.url)).filter((file) => file.endsWith(".json") && file !== "schema.json")
  .map((file) => JSON.parse(readFileSync(new URL(`../../../services/${file}`, import.meta.url))));
const reference = { ...tables.de, ...tables.en }; // what is English in the models alone stands in the other tables
const forms_of = (entry) => (typeof entry === "string" ? [entry] : Object.values(entry));
const places_in = (text) => [...new Set([...text.matchAll(/\{(\w+)\}/g)].map((each) => each[1]))].sort();

/// What is called between ( and its ): the parts between commas that stand in no bracket and no text.
function arguments_at(source, from) {
  const parts = [""];
  let depth = 0;
  for (let at = from, quote = ""; ; ++at) {
    const c = source[at];
    if (c === undefined) throw new Error("no end");
    if (quote) quote = c === quote ? "" : quote;
    else if (c === '"') quote = c;
    else if ("([{".includes(c)) ++depth;
    else if (")]}".includes(c) && --depth < 0) return parts;
    if (c === "," && depth === 0 && !quote) parts.push("");
    else parts[parts.length - 1] += c;
  }
}

/// [{file, name, given}] of every text that the sources ask for by name; `given`: the names of the values.
const asked = sources.flatMap(([file, source]) => [...source.matchAll(/(?<![\w.])t\("([^"]+)"/g)].map((match) => {
  const [, values = "{}"] = arguments_at(source, match.index + 2);
  const given = arguments_at(`${values.trim().slice(1, -1)})`, 0).map((part) => /^\s*(\w+)/.exec(part)?.[1]).filter(Boolean).sort();
  return { file, name: match[1], given };
}));
const in_document = [...read("index.html").matchAll(/data-text="([^"]+)"/g)].map((match) => match[1]);
const families = sources.flatMap(([, source]) => [...source.matchAll(/(?:t|known_text)\(`([a-z]+)\.\$\{/g)].map((match) => match[1]));

test("EachLanguageOfThePage_HasATable", () => assert.deepEqual(Object.keys(tables).sort(), Object.keys(kLanguages).sort()));

test("EachTextThatIsAskedFor_StandsInEveryLanguage", () => {
  assert.ok(asked.length > 400);
  for (const [language, table] of Object.entries(tables)) {
    assert.deepEqual([...asked.map((each) => each.name), ...in_document].filter((name) => !Object.hasOwn(table, name)), [], language);
    assert.deepEqual(Object.keys(tables.en).filter((name) => !Object.hasOwn(table, name)), [], language);
  }
});

test("EachEntry_IsUsed", () => {
  const used = new Set([...asked.map((each) => each.name), ...in_document]);
  for (const [language, table] of Object.entries(tables)) {
    assert.deepEqual(Object.keys(table).filter((name) => !used.has(name) && !families.includes(name.split(".")[0])), [], language);
  }
});

test("Values_HaveAPlaceInEveryLanguage", () => {
  for (const { file, name, given } of asked) assert.deepEqual(given, [...new Set(forms_of(tables.en[name]).flatMap(places_in))].sort(), `${file}: ${name}`);
  for (const [language, table] of Object.entries(tables)) {
    for (const [name, entry] of Object.entries(table)) {
      for (const text of forms_of(entry)) assert.deepEqual(places_in(text), [...new Set(forms_of(reference[name]).flatMap(places_in))].sort(), `${language}: ${name}`);
    }
  }
});

test("Numbers_HaveTheFormsOfTheLanguage", () => {
  for (const [language, table] of Object.entries(tables)) {
    const forms = new Set([...Array(200).keys()].map((n) => new Intl.PluralRules(language).select(n)));
    for (const [name, entry] of Object.entries(table)) {
      assert.equal(typeof entry === "object", typeof reference[name] === "object", `${language}: ${name}`);
      if (typeof entry === "object") assert.deepEqual(Object.keys(entry).sort(), [...forms].sort(), `${language}: ${name}`);
    }
  }
});

test("NoTable_KeepsAnEnglishSentence", () => {
  for (const [language, table] of Object.entries(tables)) {
    if (language === "en") continue;
    const same = Object.keys(table).filter((name) => forms_of(table[name]).some((text) => forms_of(tables.en[name] ?? name.replace(/^\w+\./, "")).includes(text) && / \w+ \w+/.test(text)));
    assert.deepEqual(same, [], language);
  }
});

test("NoTextForAPerson_StandsInTheSources", () => {
  const commands = /^(?:sudo |asip|echo |journalctl |https?:|12px |Mega 2560$|Home Assistant$|Web of Things$|input, select$|M\d| is not heard$)/;
  const logged = /console\.(?:warn|error)\(/;
  for (const [file, source] of sources) {
    if (["core/language.js", "core/link.js"].includes(file)) continue; // the latter speaks to the gateway alone
    const left = source.split("\n").filter((line) => !logged.test(line)).flatMap((line) => [...line.replace(/(?<![\w.])t\("[^"]*"/g, "").matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((match) => match[1]))
      .filter((text) => (/[A-Za-z]{2} [a-z]{2,} [a-z]{2,}|^[A-Z][a-z]+ [a-z]+|[a-z]{2}[.…?!]$/.test(text)) && !commands.test(text));
    assert.deepEqual(left, [], file);
  }
});

test("SentencesOfStatesAndAnswers_AreThoseOfTheVectors", () => {
  const { states } = vector("reasons");
  const { words, maybe } = vector("answers");
  assert.equal(tables.en.maybe, maybe);
  const of = (family) => Object.fromEntries(Object.entries(tables.en).filter(([name]) => name.startsWith(`${family}.`)).map(([name, text]) => [name.slice(family.length + 1), text]));
  assert.deepEqual({ "": "", ...of("reason") }, states);
  const { connection, ...refused } = of("answer.refused"); // the page's own, with the gateway
  assert.ok(connection);
  assert.deepEqual({ timeout: of("answer.timeout"), refused }, words);
});

test("TitlesOfModels_AndTheirArguments_StandInEveryLanguage", () => {
  const entries = new Set(models.flatMap((model) => [model.title, ...(model.match ?? []).filter((title) => title.includes("Sensors")), ...Object.values(model.commands ?? {}).map((command) => command.title)]).filter(Boolean).map((title) => `model.${title}`));
  const arguments_of = ({ name, names, items = [] }) => [name, ...Object.keys(names ?? {}), ...items.flatMap(arguments_of)];
  const words_of_models = new Set(models.flatMap((model) => Object.values(model.commands ?? {}).flatMap((command) => command.args ?? [])).flatMap(arguments_of));
  for (const [language, table] of Object.entries(tables).filter(([name]) => name !== "en")) {
    const simple = (title) => title.toLowerCase().split(" ").every((word) => `word.${word}` in table);
    assert.deepEqual([...entries].filter((entry) => !(entry in table) && !simple(entry.slice(6))), [], language);
    assert.deepEqual(Object.keys(table).filter((name) => /^(?:model|do)\./.test(name) && !entries.has(name.replace("do.", "model."))), [], `${language}: of no model`);
    assert.deepEqual([...words_of_models].filter((name) => ![`arg.${name}`, `mode.${name}`, `word.${name}`].some((key) => key in table)), [], language);
    assert.deepEqual(Object.keys(tables.de).filter((name) => !(name in table)), [], language);
  }
});

/// What a registry counts, by its sources: the members of its document that are numbers, the states of boards and why it refuses a message.
function counters_of_a_registry() {
  const source = (path) => readFileSync(new URL(`../../../${path}`, import.meta.url), "utf8");
  const words_in = (text, pattern) => [...text.matchAll(pattern)].map((match) => match[1]);
  const document_ = source("registry/statistics.cpp").split("std::string Statistics::document")[1];
  const own = words_in(document_, /(?:\{|document\[)"(\w+)"/g).filter((name) => !["version", "epoch", "seq", "at", "uptime", "boards", "services", "refused"].includes(name) && !name.endsWith("_fault"));
  const states = Object.keys(tables.en).filter((name) => name.startsWith("state.")).map((name) => name.slice(6)).filter((name) => name !== "no-asip"); // the page's own
  const reasons = words_in(source("asip/catalogue/catalogue.cpp").split("to_text(Refusal")[1].split("\n}\n")[0], /"([\w-]+)"/g).filter((name) => name !== "not-for-us");
  return [...own, ...states.map((name) => `boards ${name}`), ...reasons.map((name) => `refused ${name}`)];
}

test("Counters_HaveATitleInEveryLanguage_AndNoneIsEnglishInGerman", () => {
  const counters = counters_of_a_registry();
  assert.ok(counters.length >= 28 && counters.includes("messages") && counters.includes("boards lost") && counters.includes("refused too-many"), counters.join());
  for (const [language, table] of Object.entries(tables)) assert.deepEqual(Object.keys(table).filter((name) => name.startsWith("counter.")).sort(), counters.map((name) => `counter.${name}`).sort(), language);
  speak("en", tables.en);
  const english = counters.map(counter_text);
  speak("de", tables.de);
  assert.deepEqual(counters.filter((name, i) => [english[i], name, words(name)].includes(counter_text(name))), []);
  assert.equal(counter_text("refused by_chance"), "Refused by chance", "of a later version: plain words");
  speak("en", tables.en);
});

test("ButtonsAndTitles_AreInTheLanguage", () => {
  const { commands, element } = models.find((model) => model.name === "motors");
  const texts = (name, chosen) => [title_text(commands[name].title), button_text(commands[name], name, element, chosen)];
  speak("de", tables.de);
  assert.deepEqual([texts("stop", "0"), texts("stop-all"), texts("drive")], [["Einen Motor anhalten", "Motor 0 anhalten"], ["Alle Motoren anhalten", "Alle Motoren anhalten"],
    ["Leistung der ersten beiden Motoren zugleich setzen", "Leistung der ersten beiden Motoren zugleich setzen"]]);
  assert.equal(button_text({ title: "Report periodically; 0 stops" }, "report"), "Regelmäßig melden");
  assert.deepEqual([argument_text("power0"), argument_text("valve"), choice_text("input-pullup"), choice_text("high"), words_of_error("INVALID_PIN")], ["Leistung 0", "Valve", "Eingang mit Pull-up", "Hoch", "diesen Pin gibt es nicht"]);
  const io = new Map(models.filter((model) => model.name === "io").map((model) => ["io", model]));
  assert.equal(asked_text('{"mode":[13,"output"]}', "io", io), "Modus von Pin 13 setzen: Ausgang");
  assert.deepEqual([with_unit(3, "steps"), title_of_service({ name: "bump", title: "Bump Sensors" })], ["3\u00a0Schritte", "Stoßsensoren"]);
  assert.deepEqual(texts("stop", "1"), ["Einen Motor anhalten", "Motor 1 anhalten"]);
  speak("en", tables.en);
  assert.deepEqual([texts("stop", "0"), argument_text("power0"), choice_text("high")], [["Stop one motor", "Stop motor 0"], "Power0", "High"]);
});

test("Text_HasItsValuesAndTheFormOfItsNumber", () => {
  speak("fr", tables.fr);
  assert.deepEqual([t("n-boards", { n: 0 }), t("n-boards", { n: 1 }), t("n-boards", { n: 2 })], ["0 carte", "1 carte", "2 cartes"]);
  assert.equal(t("remove-name", { name: "{n}" }), "Retirer {n}");
  speak("de", tables.de);
  assert.equal(t("n-boards", { n: 10000 }), "10.000 Boards");
  speak("en", tables.en);
  assert.equal(t("n-boards", { n: 10000 }), "10,000 boards");
  assert.equal(t("of-a-later-version"), "of-a-later-version");
});

test("Language_IsTheFirstThatThePageSpeaks", () => {
  assert.deepEqual([language_for(["pt-BR", "de-AT", "en"]), language_for(["EN-us"]), language_for(["ja"]), language_for([]), language_for(["constructor", "it"])], ["de", "en", "en", "en", "it"]);
});

test("NamesThatAModelGives_AreInTheLanguage_ThoseOfPeopleStay", () => {
  speak("de", tables.de);
  const named_so = (text) => named({ name: text }).name;
  assert.deepEqual(["Servo 0 angle", "Distance 1", "Temperature"].map(named_so), ["Servo 0 Winkel", "Abstand 1", "Temperatur"]);
  assert.deepEqual(["Left arm angle", "tank", "Distance of the tank", "Pin A0"].map(named_so), ["Left arm angle", "tank", "Distance of the tank", "Pin A0"]);
  assert.deepEqual([words("input-pullup"), words("distance"), title_of_service({ name: "servo", title: "Servos" }), title_of_service({ name: "valve", title: "Main valves" })], ["Input pullup", "Abstand", "Servos", "Main valves"]);
  speak("en", tables.en);
  assert.deepEqual(["Servo 0 angle", "Bump Sensors"].map(named_so), ["Servo 0 angle", "Bump Sensors"]);
});
