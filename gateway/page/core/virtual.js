// SPDX-License-Identifier: Apache-2.0
// Which rows of a long list are drawn.

/// The rows [first, end) to draw so that the viewport is covered, with `extra` rows above and below.
export function visible_rows(scroll_top, viewport_height, row_height, count, extra = 8) {
  const top = Math.max(0, Math.min(scroll_top, count * row_height - viewport_height));
  const first = Math.max(0, Math.floor(top / row_height) - extra);
  const end = Math.min(count, Math.ceil((top + viewport_height) / row_height) + extra);
  return { first, end: Math.max(first, end) };
}

/// The scroll position at which `row` is visible as a whole; the present one if it already is.
export function scroll_to_show(row, scroll_top, viewport_height, row_height) {
  const top = row * row_height;
  if (top < scroll_top) return top;
  if (top + row_height > scroll_top + viewport_height) return top + row_height - viewport_height;
  return scroll_top;
}

/// The row to which a key moves from `row`; undefined for keys that do not move.
export function moved_row(key, row, count, page) {
  if (count === 0) return undefined;
  const last = count - 1;
  const moves = { ArrowDown: row + 1, ArrowUp: row - 1, PageDown: row + page, PageUp: row - page, Home: 0, End: last };
  if (!(key in moves)) return undefined;
  return Math.max(0, Math.min(last, moves[key]));
}
