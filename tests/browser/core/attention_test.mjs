// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { attention_of, filter_of, named, query_of, title_badge } from "../../../gateway/page/core/attention.js";

const row = (name, state, reason = "", since = 0) => ({ name, state, reason, since });

test("LostAndStopped_AreCountedTheNewestFirst", () => {
  const found = attention_of([row("a", "online"), row("b", "lost", "unplugged", 10), row("c", "lost", "unplugged", 20), row("d", "lost", "silent", 5),
    row("e", "online", "latched"), row("f", "offline", "stopped")]);
  assert.deepEqual(found.lost.map((each) => each.name), ["c", "b", "d"]);
  assert.deepEqual(found.stopped.map((each) => each.name), ["e"]);
  assert.deepEqual(found.reasons, [["unplugged", 2], ["silent", 1]]);
  assert.equal(title_badge(found), "(3 lost, 1 stopped) ");
});

test("Nothing_IsNothing", () => assert.equal(title_badge(attention_of([row("a", "online")])), ""));

test("Thousands_AreNotAllNamed", () => assert.equal(named(Array.from({ length: 2000 }, (_, i) => row(`b${i}`, "lost"))).length, 5));

test("View_StandsInTheAddressAndComesBack", () => {
  const filter = { text: "room=lab & more", kind: "servo", state: "lost", value: "distance", group: "room", sort: "since", descending: true };
  assert.deepEqual(filter_of(query_of(filter)), filter);
  assert.equal(query_of(filter_of("")), "");
});

test("AddressOfAnybody_IsReadAsFarAsItIsOne", () => {
  assert.deepEqual(filter_of("sort=__proto__&descending=7&state=x&evil=1&text=%ZZ").sort, "name");
  assert.equal(filter_of("descending=7").descending, false);
});
