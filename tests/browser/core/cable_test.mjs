// SPDX-License-Identifier: Apache-2.0
// The texts of the cable, which has tables of its own.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { kLanguages } from "../../../gateway/page/core/language.js";

const folder = new URL("../../../gateway/page/cable/", import.meta.url);
const tables = Object.fromEntries(Object.keys(kLanguages).map((code) => [code, JSON.parse(readFileSync(new URL(`languages/${code}.json`, folder)))]));
const source = readFileSync(new URL("cable.js", folder), "utf8");
const places_in = (text) => [...text.matchAll(/\{\w+\}/g)].map((each) => each[0]).sort();

test("EachTextOfTheCable_StandsInEveryLanguageAndIsUsed", () => {
  const used = [...new Set([...source.matchAll(/"(cable\.[a-z-]+)"/g)].map((match) => match[1]))].sort();
  assert.ok(used.length > 10);
  for (const [code, table] of Object.entries(tables)) {
    assert.deepEqual(Object.keys(table).sort(), used, code);
    for (const name of used) assert.deepEqual(places_in(table[name]), places_in(tables.en[name]), `${code}: ${name}`);
    if (code !== "en") assert.deepEqual(used.filter((name) => table[name] === tables.en[name]), [], `${code}: an English text`);
  }
});
