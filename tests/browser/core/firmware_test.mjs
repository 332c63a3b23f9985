// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { attention_of, Losses, title_badge } from "../../../gateway/page/core/attention.js";
import { Catalogue } from "../../../gateway/page/core/catalogue.js";
import { state_text } from "../../../gateway/page/core/text.js";
import { firmware_text, loading_of, port_text, speaks_no_asip } from "../../../gateway/page/core/firmware.js";

const bare = { name: "lab-usb-140-3", state: "lost", reason: "silent", chip: "", services: [] };

test("a port where nothing ever answered is a board without ASIP; a lost board is none", () => {
  assert.equal(speaks_no_asip(bare), true);
  for (const other of [{ chip: "ATmega328P" }, { services: ["io"] }, { reason: "unplugged" }, { state: "online" }]) assert.equal(speaks_no_asip({ ...bare, ...other }), false, JSON.stringify(other));
});

test("a board without ASIP is neither lost nor news, is counted and named apart", () => {
  const catalogue = new Catalogue();
  const rows = () => [...catalogue.rows.values()];
  const losses = new Losses();
  losses.of(rows(), 0);
  catalogue.apply({ event: "online", board: { ...bare, board: "lab-usb-140-3" } }, 0);
  assert.equal(losses.of(rows(), 1), undefined);
  assert.equal(title_badge(attention_of(rows())), "");
  catalogue.apply({ event: "lost", board: { ...bare, board: "uno1", chip: "ATmega328P" } }, 0);
  const found = attention_of(rows());
  assert.deepEqual(found.bare.map((row) => row.name), ["lab-usb-140-3"]);
  assert.deepEqual(found.lost.map((row) => row.name), ["uno1"]);
  assert.deepEqual([...catalogue.counts()], [["no-asip", 1], ["lost", 1]]);
  assert.equal(state_text("no-asip"), "no ASIP sketch yet");
  assert.equal(losses.of(rows(), 2).title, "uno1 is lost");
});

test("ports are called by their USB socket where their path says it", () => {
  assert.equal(port_text("/dev/serial/by-path/pci-0000:00:14.0-usb-0:1.3:1.0-port0"), "USB port 1.3");
  assert.equal(port_text("/dev/ttyUSB0"), "/dev/ttyUSB0");
  assert.equal(port_text(undefined), "");
});

test("a board whose agent has a newer version is out of date while it is there", () => {
  const old = { sketch: "AsipServices", version: "0.2", available: "0.3" };
  assert.equal(firmware_text(old), "AsipServices 0.2, out of date");
  assert.equal(firmware_text({ sketch: "Mine" }), "Mine");
  const catalogue = new Catalogue();
  catalogue.apply({ event: "online", board: { ...old, board: "uno1" } }, 0);
  catalogue.apply({ event: "lost", board: { ...old, board: "uno2", chip: "ATmega328P" } }, 0);
  catalogue.apply({ event: "online", board: { ...old, board: "uno3", available: "" } }, 0);
  const found = () => attention_of([...catalogue.rows.values()].map((row) => ({ ...row, state: row.name === "uno2" ? "lost" : "online" }))).outdated.map((row) => row.name);
  assert.deepEqual(found(), ["uno1"]);
  catalogue.apply({ event: "changed", board: { ...old, board: "uno1", version: "0.3", available: undefined } }, 0);
  assert.deepEqual(found(), []);
});

test("how far the loading is", () => {
  const at = (updating) => loading_of({ updating });
  assert.deepEqual(at({ firmware: "AsipServices", step: "writing", percent: 40 }), { percent: 20, text: "AsipServices: writing 40 %" });
  assert.deepEqual(at({ firmware: "AsipServices", step: "verifying", percent: 40 }), { percent: 70, text: "AsipServices: verifying 40 %" });
  assert.equal(at({ firmware: "AsipServices", step: "starting", percent: 0 }).percent, 100);
  assert.equal(at({ by: "ann", until: "2026-11-21T10:00:00.000Z" }), undefined);
  assert.equal(loading_of(undefined), undefined);
  assert.equal(at({ firmware: "x", step: "writing", percent: "<b>" }).percent, 0);
});
