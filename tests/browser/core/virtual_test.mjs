// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { moved_row, scroll_to_show, visible_rows } from "../../../gateway/page/core/virtual.js";

test("AtTop_DrawsFromFirstRow", () => {
  assert.deepEqual(visible_rows(0, 400, 40, 10_000, 5), { first: 0, end: 15 });
});

test("InTheMiddle_CoversTheViewportWithExtraRowsOnBothSides", () => {
  assert.deepEqual(visible_rows(4010, 400, 40, 10_000, 5), { first: 95, end: 116 });
});

test("AtTheEnd_EndsWithTheLastRow", () => {
  assert.deepEqual(visible_rows(399_600, 400, 40, 10_000, 5), { first: 9985, end: 10_000 });
});

test("ListShrankBelowTheScrollPosition_DrawsItsEnd", () => {
  assert.deepEqual(visible_rows(390_000, 400, 40, 20, 5), { first: 5, end: 20 });
});

test("EmptyList_DrawsNothing", () => {
  assert.deepEqual(visible_rows(0, 400, 40, 0), { first: 0, end: 0 });
});

test("EveryScrollPosition_CoversTheViewport", () => {
  for (let top = 0; top <= 100 * 40 - 400; ++top) {
    const { first, end } = visible_rows(top, 400, 40, 100, 0);
    assert.ok(first * 40 <= top && end * 40 >= top + 400, `at ${top}`);
  }
});

test("RowAboveOrBelow_ScrollsJustEnough", () => {
  assert.equal(scroll_to_show(5, 400, 400, 40), 200);
  assert.equal(scroll_to_show(12, 400, 400, 40), 400);
  assert.equal(scroll_to_show(20, 400, 400, 40), 440);
});

test("Keys_MoveWithinTheList", () => {
  assert.equal(moved_row("ArrowDown", 3, 10, 4), 4);
  assert.equal(moved_row("ArrowUp", 0, 10, 4), 0);
  assert.equal(moved_row("PageDown", 8, 10, 4), 9);
  assert.equal(moved_row("Home", 8, 10, 4), 0);
  assert.equal(moved_row("End", 0, 10, 4), 9);
  assert.equal(moved_row("a", 3, 10, 4), undefined);
  assert.equal(moved_row("ArrowDown", 0, 0, 4), undefined);
});
