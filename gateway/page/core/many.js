// SPDX-License-Identifier: Apache-2.0
// One task for many boards: a few at a time, and again a moment later where the gateway says that it was too much at once.
import { t } from "./language.js";

const kAtOnce = 8;
const kTries = 60;
const kWaitMs = 1000;

/// Calls `task(name)` for each name. {done: number, failed: [[name, sentence]]}; `progress` is called with how many have ended.
export async function for_each_board(names, task, { progress = () => {}, wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms)) } = {}) {
  const left = [...names];
  const result = { done: 0, failed: [] };
  const work = async () => {
    for (let name = left.shift(); name !== undefined; name = left.shift()) {
      const fault = await attempt(name, task, wait);
      if (fault === undefined) ++result.done;
      else result.failed.push([name, fault]);
      progress(result.done + result.failed.length);
    }
  };
  await Promise.all(Array.from({ length: Math.min(kAtOnce, left.length) }, work));
  return result;
}

async function attempt(name, task, wait) {
  for (let i = 0; ; ++i) {
    try {
      return await task(name);
    } catch (problem) {
      if (problem.status !== 429 || i >= kTries) return problem.message;
    }
    await wait(kWaitMs);
  }
}

const kBodyBytes = 60_000;

/// The names as lists, each of which fits into the body of one request.
export function lists_of(names, most = kBodyBytes) {
  const lists = [];
  let bytes = most;
  for (const name of names) {
    bytes += name.length + 3;
    if (bytes > most) {
      lists.push([]);
      bytes = name.length + 3;
    }
    lists.at(-1).push(name);
  }
  return lists;
}

/// What the answer to one request for these boards says, as for_each_board() says it.
export function result_of(names, answer) {
  const failed = names.map((name) => [name, answer?.boards?.[name]]).filter(([, of_board]) => of_board?.status !== "ok")
    .map(([name, of_board]) => [name, of_board?.error ?? t("no-proof")]);
  return { done: names.length - failed.length, failed };
}

/// "Done on 3 boards.", or what failed where.
export function many_text({ done, failed }) {
  if (failed.length === 0) return t("done-n", { n: done });
  const some = failed.slice(0, 3).map(([name, why]) => `${name}: ${why}`).join("; ");
  return `${t("done-done", { done, n: done + failed.length })} ${some}${failed.length > 3 ? ` … ${t("n-more", { n: failed.length - 3 })}` : ""}`;
}
