// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { answer_ms, Link } from "../../../gateway/page/core/link.js";

const sent = (actions) => actions.filter((action) => action.send).map((action) => action.send);
const delivered = (actions) => actions.filter((action) => action.deliver).map((action) => action.deliver);

function open_link() {
  const link = new Link(() => 1);
  link.start(0);
  link.opened(10);
  link.take_actions();
  return link;
}

test("Answer_IsWaitedForAsLongAsTheGatewayMayTake_AndLonger", () => {
  assert.equal(answer_ms("api/boards"), 15_000);
  assert.equal(answer_ms("api/boards/uno1/labels?deadline_ms=50"), 15_000);
  assert.equal(answer_ms("api/boards/uno1/load?deadline_ms=60000"), 70_000);
  assert.equal(answer_ms("api/boards/uno1/services/io/value?after=&wait=60"), 70_000);
});

test("Start_OpensOnce", () => {
  const link = new Link();
  link.start(0);
  link.start(1);
  assert.equal(link.take_actions().filter((action) => action.open).length, 1);
});

test("SubscribedBeforeOpen_IsSentWhenOpen", () => {
  const link = new Link();
  link.subscribe("1", { subscribe: "uno1/io" });
  link.start(0);
  assert.deepEqual(sent(link.take_actions()), []);
  link.opened(5);
  assert.deepEqual(sent(link.take_actions()), [{ subscribe: "uno1/io", ref: "1" }]);
});

test("ConnectionCut_ResumesBehindTheLastPlace", () => {
  const link = open_link();
  link.subscribe("1", { subscribe: "uno1/io" });
  link.received({ ref: "1", event: "snapshot-end", place: "e-3" }, 20);
  link.received({ ref: "1", event: "value", place: "e-4" }, 21);
  link.closed(30);
  link.tick(1000);
  link.opened(1010);
  assert.deepEqual(sent(link.take_actions()).at(-1), { subscribe: "uno1/io", ref: "1", after: "e-4" });
});

test("ConnectionCutWithinTheSnapshot_BeginsAnewAndSaysSo", () => {
  const link = open_link();
  link.subscribe("1", { subscribe: "$catalogue" });
  link.received({ ref: "1", event: "board", board: { board: "uno1" } }, 20);
  link.closed(30);
  link.tick(1000);
  link.take_actions();
  link.opened(1010);
  const actions = link.take_actions();
  assert.deepEqual(sent(actions), [{ subscribe: "$catalogue", ref: "1" }]);
  assert.equal(delivered(actions)[0].event, "reset");
});

test("Reset_ForgetsThePlace", () => {
  const link = open_link();
  link.subscribe("1", { subscribe: "uno1/io" });
  link.received({ ref: "1", event: "value", place: "e-4" }, 20);
  link.received({ ref: "1", event: "reset" }, 21);
  link.closed(30);
  link.tick(1000);
  link.opened(1010);
  assert.equal(sent(link.take_actions()).at(-1).after, undefined);
});

test("SubscriptionRefused_IsTriedAgain", () => {
  const link = open_link();
  link.subscribe("1", { subscribe: "uno1/io" });
  link.take_actions();
  link.received({ ref: "1", error: "the broker is not connected" }, 100);
  link.take_actions();
  link.tick(1000);
  assert.deepEqual(sent(link.take_actions()), []);
  link.tick(1700);
  assert.deepEqual(sent(link.take_actions()), [{ subscribe: "uno1/io", ref: "1" }]);
});

test("EventsOfAnEndedSubscription_AreNotDelivered", () => {
  const link = open_link();
  link.subscribe("1", { subscribe: "uno1/io" });
  link.unsubscribe("1");
  assert.deepEqual(sent(link.take_actions()).at(-1), { unsubscribe: "1" });
  link.received({ ref: "1", event: "value" }, 20);
  assert.deepEqual(link.take_actions(), []);
});

test("CommandWithoutConnection_IsRefusedAndNeverSentLater", () => {
  const link = new Link();
  link.start(0);
  link.command("7", { command: "uno1/servo" }, 1);
  assert.deepEqual(delivered(link.take_actions()).map(({ status, reason }) => [status, reason]), [["refused", "connection"]]);
  link.opened(5);
  assert.deepEqual(sent(link.take_actions()), []);
});

const fetched = (actions) => actions.filter((action) => action.fetch).map((action) => action.fetch);

function link_cut_under_way(request = { command: "uno1/servo" }) {
  const link = open_link();
  link.command("7", request, 20);
  link.closed(30);
  return link;
}

test("ConnectionCutWhileACommandIsUnderWay_ItsOutcomeIsFetchedOnceConnectedAgain", () => {
  const link = link_cut_under_way();
  assert.deepEqual(delivered(link.take_actions()), []);
  link.tick(1000);
  assert.deepEqual(fetched(link.take_actions()), [], "there is no connection yet");
  link.opened(1010);
  assert.deepEqual(fetched(link.take_actions()), ["7"]);
  link.fetched("7", { id: "7" }, 1020);
  assert.deepEqual(link.take_actions(), [], "it is still under way");
  link.tick(1300);
  assert.deepEqual(fetched(link.take_actions()), []);
  link.tick(1600);
  assert.deepEqual(fetched(link.take_actions()), ["7"]);
  link.fetched("7", { id: "7", answer: { status: "ok", proof: "fence" } }, 1610);
  assert.deepEqual(delivered(link.take_actions()), [{ id: "7", status: "ok", proof: "fence" }]);
  link.tick(60_000);
  assert.deepEqual(delivered(link.take_actions()), []);
});

test("GatewayDoesNotKnowTheCommandThatWasCut_IsATimeout", () => {
  const link = link_cut_under_way();
  link.tick(1000);
  link.opened(1010);
  link.fetched("7", null, 1020);
  assert.deepEqual(delivered(link.take_actions()), [{ id: "7", status: "timeout", reason: "connection" }]);
});

test("NoConnectionLongAfterACommandWasCut_IsATimeoutAndNothingElse", () => {
  const link = link_cut_under_way();
  link.tick(10_000);
  assert.deepEqual(delivered(link.take_actions()), []);
  link.tick(15_021);
  assert.deepEqual(delivered(link.take_actions()), [{ id: "7", status: "timeout", reason: "connection" }]);
  link.opened(15_030);
  assert.deepEqual(fetched(link.take_actions()), []);
});

test("ConnectionCutWhileAHeldCommandIsUnderWay_IsATimeoutAtOnce", () => {
  const link = link_cut_under_way({ command: "uno1/motors", hold_ms: 500 });
  assert.deepEqual(delivered(link.take_actions()), [{ id: "7", status: "timeout", reason: "connection" }]);
});

test("NoAnswerLongAfterTheDeadline_IsATimeout_AndALateOneIsDropped", () => {
  const link = open_link();
  link.command("7", { command: "uno1/servo", deadline_ms: 1000 }, 0);
  link.take_actions();
  link.tick(5000);
  assert.deepEqual(link.take_actions(), []);
  link.tick(11_001);
  assert.deepEqual(delivered(link.take_actions()), [{ id: "7", status: "timeout" }]);
  link.received({ id: "7", status: "ok" }, 11_500);
  assert.deepEqual(link.take_actions(), []);
});

test("HeldCommand_AnswersAgainOnlyWhenItIsNotHeldAnyMore", () => {
  const link = open_link();
  link.command("7", { command: "uno1/motors", hold_ms: 500 }, 20);
  link.received({ id: "7", status: "ok" }, 21);
  link.take_actions();
  link.renew("7", { command: "uno1/motors" });
  assert.deepEqual(sent(link.take_actions()), [{ command: "uno1/motors", id: "7", renew: true }]);
  link.received({ id: "7", status: "refused", reason: "not-held" }, 30);
  link.received({ id: "7", status: "refused", reason: "not-held" }, 31);
  assert.deepEqual(delivered(link.take_actions()).map(({ reason }) => reason), ["not-held"]);
});

test("ConnectionCutWhileHolding_IsSaid", () => {
  const link = open_link();
  link.command("7", { command: "uno1/motors", hold_ms: 500 }, 20);
  link.received({ id: "7", status: "ok" }, 21);
  link.renew("7", { command: "uno1/motors" });
  link.take_actions();
  link.closed(30);
  assert.deepEqual(delivered(link.take_actions()), [{ id: "7", status: "timeout", reason: "connection" }]);
});

test("FailuresInARow_WaitLongerUpToALimit", () => {
  const link = new Link(() => 1);
  link.start(0);
  const waits = [];
  let now = 0;
  for (let i = 0; i < 8; ++i) {
    link.closed(now);
    waits.push(link.retry_at - now);
    now = link.retry_at;
    link.tick(now);
  }
  assert.deepEqual(waits, [400, 800, 1600, 3200, 6400, 10_000, 10_000, 10_000]);
});

test("MessageReceived_ResetsTheWait", () => {
  const link = new Link(() => 1);
  link.start(0);
  for (let i = 0; i < 3; ++i) {
    link.closed(0);
    link.hurry(0);
  }
  link.opened(0);
  link.received({ ref: "x", ok: true }, 1);
  link.closed(2);
  assert.equal(link.retry_at - 2, 400);
});

test("Hurry_ConnectsAtOnce", () => {
  const link = open_link();
  link.closed(30);
  link.take_actions();
  link.hurry(31);
  assert.ok(link.take_actions().some((action) => action.open));
});

test("SilentConnection_IsAskedThenGivenUp", () => {
  const link = open_link();
  link.tick(45_011);
  assert.deepEqual(sent(link.take_actions()), [{ unsubscribe: "alive?" }]);
  link.tick(55_100);
  const actions = link.take_actions();
  assert.ok(actions.some((action) => action.close));
  assert.equal(link.state, "waiting");
});

test("SilentConnectionThatAnswers_IsKept", () => {
  const link = open_link();
  link.tick(45_011);
  link.received({ ref: "alive?", error: "there is no subscription of this ref" }, 45_100);
  link.tick(56_000);
  assert.equal(link.state, "open");
});

test("OpeningTakesTooLong_IsGivenUpAndTriedAgain", () => {
  const link = new Link(() => 1);
  link.start(0);
  link.tick(10_001);
  assert.equal(link.state, "waiting");
  link.tick(10_500);
  assert.equal(link.state, "connecting");
});
