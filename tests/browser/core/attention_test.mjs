// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { attention_of, filter_of, Losses, named, query_of, title_badge } from "../../../gateway/page/core/attention.js";

const row = (name, state, reason = "", since = 0) => ({ name, state, reason, since, chip: "ATmega328P" });

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

test("Losses_AreToldOnce_ThoseOfTheBeginningNever", () => {
  const losses = new Losses();
  assert.equal(losses.of([row("old", "lost")], 0), undefined);
  assert.equal(losses.of([row("old", "lost"), row("a", "online")], 1), undefined);
  const lost = { ...row("a", "lost"), reason: "unplugged", called: "left desk" };
  assert.deepEqual(losses.of([row("old", "lost"), lost], 10), { title: "left desk is lost", body: "cable unplugged" });
  assert.equal(losses.of([row("old", "lost"), lost], 20), undefined);
  assert.equal(losses.of([row("a", "online")], 30), undefined);
  assert.equal(losses.of([row("old", "lost"), lost], 10_000).title, "2 boards lost", "lost again is news again");
});

test("LossOfMany_IsOneNoticeThatGrows_AndALaterOneIsAnother", () => {
  const losses = new Losses();
  const all = Array.from({ length: 2000 }, (_, i) => ({ ...row(`b${i}`, "lost"), reason: "agent-gone" }));
  losses.of([], 0);
  assert.equal(losses.of(all.slice(0, 700), 1000).title, "700 boards lost");
  const notice = losses.of(all.slice(0, 1999), 1400);
  assert.equal(notice.title, "1,999 boards lost");
  assert.equal(notice.body, "b0, b1, b2, b3, b4, …: its agent died or lost the broker");
  assert.equal(losses.of(all, 60_000).title, "b1999 is lost");
  losses.of([], 60_100);
  assert.equal(losses.of(all.slice(1999), 60_200).title, "b1999 is lost", "one board that comes and goes is one");
});

test("View_StandsInTheAddressAndComesBack", () => {
  const filter = { text: "room=lab & more", kind: "servo", state: "lost", value: "distance", group: "room", sort: "since", descending: true };
  assert.deepEqual(filter_of(query_of(filter)), filter);
  assert.equal(query_of(filter_of("")), "");
});

test("AddressOfAnybody_IsReadAsFarAsItIsOne", () => {
  assert.deepEqual(filter_of("sort=__proto__&descending=7&state=x&evil=1&text=%ZZ").sort, "name");
  assert.equal(filter_of("descending=7").descending, false);
});
