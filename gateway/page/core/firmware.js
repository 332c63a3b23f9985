// SPDX-License-Identifier: Apache-2.0
// Boards that speak no ASIP: their port is known, and their agent can load firmware into them.
import { known_text, t } from "./language.js";

/// `board`: a row of the table, or a board of the API. True: nothing has ever answered at its port.
export function speaks_no_asip(board) {
  return board.state === "lost" && board.reason === "silent" && !board.chip && (board.services?.length ?? 0) === 0;
}

/// The state as views show and count it: a port where nothing has ever answered was never there to be lost.
export const shown_state = (board) => (speaks_no_asip(board) ? "no-asip" : board.state);

/// "AsipServices 0.2, out of date" of such a board.
export function firmware_text({ sketch, version, available }) {
  return [[sketch, version].filter(Boolean).join(" "), available && t("out-of-date")].filter(Boolean).join(", ");
}

/// "USB port 1.3" for a path such as ...pci-0000:00:14.0-usb-0:1.3:1.0-port0; else what is given.
export function port_text(path) {
  const found = /-usb-[^:]*:([^:]+):[^/]*$/.exec(path ?? "");
  return found ? t("usb-port-port", { port: found[1] }) : path ?? "";
}

/// What a description says of firmware that is being loaded: {percent, text}; undefined: none is.
export function loading_of(description) {
  const { firmware, step, percent } = description?.updating ?? {};
  if (typeof firmware !== "string") return undefined;
  const done = step === "writing" || step === "verifying" ? ` ${percent} %` : "";
  // Writing and reading back take equally long.
  const part = { writing: percent / 2, verifying: 50 + percent / 2, starting: 100 }[step] ?? 0;
  return { percent: Math.max(0, Math.min(100, Number(part) || 0)), text: `${firmware}: ${known_text(`step.${step}`) ?? step}${done}` };
}
