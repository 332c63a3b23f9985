# SPDX-License-Identifier: Apache-2.0
"""Events late and in any order: each event of a program or of a broker at each moment of a connection. No thread ends, no call waits for ever, no
callback is lost, and the next connection serves."""
import concurrent.futures
import gc
import json
import threading
import time
import unittest
import unittest.mock

import asip
from asip import _wait, testing
from asip.bus import Bus
from asip.service import Watch
from asip.settings import Settings

PATIENCE = 60  # seconds for what must come at last: a machine with other work to do is late, and not wrong


def eventually(condition, seconds=PATIENCE):
    return testing.eventually(condition, seconds)


LIST = {"version": 1, "board": "desk", "session": "s", "seq": 1, "properties": [
    {"id": "io/2", "name": "Pin 2", "service": "io", "kind": "binary", "type": "boolean", "access": "read", "choices": [["off", 1], ["on", 0]], "read": "/digital/2",
     "meaning": {"class": "button"}}]}
VALUES = {"version": 1, "board": "desk", "session": "s", "seq": 2, "values": {"io/2": {"value": True, "how": "reported", "age": 0, "events": [[1, "press"]]}}}
DESCRIBED = "asip/servicebus/desk/$description"
DESCRIPTION = {"board": "desk", "session": "s", "seq": 1, "lease": 60, "state": {"is": "online", "age": 0},
               "services": [{"name": "servo", "model": "servo@1"}, {"name": "distance", "model": "distance@1"}, {"name": "io", "model": "io@1"}]}


def carrying(function):
    """What comes from a broker comes in a thread that carries messages: a function that waits there is told so."""
    def run(*args):
        _wait.forbid()
        try:
            return function(*args)
        finally:
            _wait._forbidden.here = False
    return run


class HandLink:
    """A connection that a test moves by hand."""

    def __init__(self, rig, _broker, _settings, _id, v5, on_up, on_down, on_message, on_denied):
        self.rig, self.v5 = rig, v5
        self.on_up, self.on_down, self.on_message, self.on_denied = map(carrying, (on_up, on_down, on_message, on_denied))
        self.sent, self.closed, self.frozen = [], False, False
        rig.links.append(self)

    def start(self):
        if self.rig.refuses:
            raise ConnectionRefusedError("refused")

    def publish(self, topic, payload, _qos, _expiry, _key=None):
        self.sent.append((topic, payload))

    def subscribe(self, topic, _qos):
        if self.rig.serves and topic.endswith("/$description"):
            threading.Thread(target=self.tell, args=(DESCRIBED, DESCRIPTION, True), daemon=True).start()

    def unsubscribe(self, topic):
        pass

    def close(self):
        self.closed = True

    # What a broker does
    def up(self):
        self.on_up(self.v5)

    def hello(self):
        self.tell(self.rig.bus._engine.session.topics.own(), b"hello")

    def tell(self, topic, payload, retained=False):
        if self.frozen:  # it says nothing, and its connection does not even end
            return
        self.on_message(topic, payload if isinstance(payload, bytes) else json.dumps(payload).encode(), retained, None)

    def answer_all(self):
        for topic, payload in [*self.sent]:
            request = json.loads(payload) if payload.startswith(b"{") else {}
            if "reply_to" in request:
                self.tell(request["reply_to"], {"id": request["id"], "status": "ok", "proof": "fence", **({"answer": {**LIST, **VALUES}} if "list" in request else {})})


class Rig:
    def __init__(self):
        self.links, self.refuses, self.serves, self.calls, self.errors = [], False, False, [], []
        self.engine_faults = 0
        self.bus = Bus(Settings(source="a test"), timeout=0.4, by=None, link=lambda *args: HandLink(self, *args))
        self.engine = self.bus._engine
        self.bus.on_error = self.errors.append
        eventually(lambda: self.links)

    @property
    def link(self):
        return self.links[-1]

    def serve(self):
        self.serves = True
        self.link.up()
        self.link.hello()
        self.link.tell(DESCRIBED, DESCRIPTION)

    def call(self, function):
        """In a thread of its own, as a program does it; its end is looked at later."""
        def run():
            try:
                ends.append(function())
            except BaseException as error:  # noqa: BLE001
                ends.append(error)
        ends = []
        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        self.calls.append((thread, ends))

    def next_link(self):
        """The connection that follows one that has ended."""
        self.refuses = False
        before = len(self.links)
        eventually(lambda: len(self.links) > before and self.engine._link is self.links[-1])


MOMENTS = {
    "connecting": lambda rig: None,
    "refused": lambda rig: (setattr(rig, "refuses", True), rig.link.on_down("gone", "closed"), eventually(lambda: len(rig.links) > 1)),
    "accepted": lambda rig: rig.link.up(),
    "serving": lambda rig: rig.serve(),
    "asked": lambda rig: (rig.serve(), rig.call(lambda: rig.bus.board("desk").servo.write(0, 90)), eventually(lambda: any(b"write" in one for _, one in rig.link.sent))),
    "frozen": lambda rig: (rig.serve(), setattr(rig.link, "frozen", True)),
    "lost": lambda rig: (rig.serve(), rig.link.on_down("cut", "other")),
    "closed": lambda rig: (rig.serve(), rig.bus.close()),
}


def raises(error):
    def function(*_):
        raise error
    return function


def hangs_on_a_future(rig, function):
    future = rig.engine.ask(lambda session, now: session.command(now, "desk", "servo", "write", {"write": [0, 1]}, 0.1)).future
    future.add_done_callback(function)


def late(what):
    """What the first connection says when it is not the one any more, or is."""
    return lambda rig: what(rig.links[0])


EVENTS = {
    "close": lambda rig: rig.bus.close(),
    "close twice at once": lambda rig: [rig.call(rig.bus.close) for _ in range(2)],
    "command": lambda rig: rig.call(lambda: rig.bus.board("desk").servo.write(0, 1)),
    "read": lambda rig: rig.call(lambda: rig.bus.board("desk").distance.read()),
    "pin": lambda rig: rig.call(lambda: rig.bus.board("desk").pin(13).on()),
    "pin read": lambda rig: rig.call(lambda: rig.bus.board("desk").pin(13).read()),
    "property read": lambda rig: rig.call(lambda: rig.bus.board("desk")["io/2"].read()),
    "property write": lambda rig: rig.call(lambda: rig.bus.board("desk")["io/2"].write(True)),
    "properties": lambda rig: rig.call(lambda: rig.bus.board("desk").properties),
    "events of a button": lambda rig: rig.call(lambda: next(rig.bus.board("desk")["io/2"].events(timeout=0.4))),
    "function for a button": lambda rig: rig.call(lambda: rig.bus.board("desk")["io/2"].on_event(raises(SystemExit(3)))),
    "query": lambda rig: rig.call(lambda: rig.bus.query({"find": "boards"})),
    "boards": lambda rig: rig.call(rig.bus.boards),
    "stop": lambda rig: rig.call(lambda: rig.bus.stop("desk")),
    "watch": lambda rig: rig.call(lambda: rig.bus.watch(lambda *_: None)),
    "hold": lambda rig: rig.call(lambda: rig.bus.board("desk").servo.hold(write=[0, 1]).__enter__()),
    "future whose callback exits": lambda rig: hangs_on_a_future(rig, raises(SystemExit(3))),
    "future whose callback waits": lambda rig: hangs_on_a_future(rig, lambda _: rig.engine.stop("desk", 1).future and rig.bus.board("desk").servo.write(0, 1)),
    "function that exits": lambda rig: rig.engine.dispatcher.put(raises(SystemExit(3)), ()),
    "function that is interrupted": lambda rig: rig.engine.dispatcher.put(raises(KeyboardInterrupt()), ()),
    "function that closes": lambda rig: rig.engine.dispatcher.put(rig.bus.close, ()),
    "sink that exits": lambda rig: rig.engine.do(lambda session, now: session.watch(now, "desk", "distance", raises(SystemExit(3)), 1)),
    "late CONNACK": late(lambda link: link.up()),
    "late hello": late(lambda link: link.hello()),
    "late end": late(lambda link: link.on_down("late", "other")),
    "late end, again": late(lambda link: (link.on_down("late", "closed"), link.on_down("late", "silent"))),
    "late value": late(lambda link: link.tell("asip/desk/distance/out", {"distance": [1, 2]})),
    "late description": late(lambda link: link.tell("asip/servicebus/desk/$description", DESCRIPTION, True)),
    "late list": late(lambda link: link.tell("asip/servicebus/desk/$properties", LIST, True)),
    "late values": late(lambda link: [link.tell("asip/desk/$values", {**VALUES, "seq": seq}, seq == 2) for seq in (2, 3, 1)]),
    "late answer": late(lambda link: link.answer_all()),
    "late denial": late(lambda link: link.on_denied("python-x-1")),
    "garbage": lambda rig: (rig.bus._of("desk"), gc.collect()),
}


class Moments(unittest.TestCase):
    def cell(self, moment, event):
        rig = Rig()
        self.addCleanup(rig.engine.close)
        MOMENTS[moment](rig)
        try:
            EVENTS[event](rig)
        except asip.Closed:
            self.assertTrue(rig.engine.closed)
        if rig.engine.closed or "close" in event:
            eventually(lambda: rig.engine.closed)
        else:
            self.serves(rig)
        for thread, ends in rig.calls:
            thread.join(PATIENCE)
            self.assertFalse(thread.is_alive(), "a call that waits for ever")
            if ends and isinstance(ends[0], BaseException):
                self.assertIsInstance(ends[0], asip.Error)
        if not rig.engine.closed:
            self.calls_functions(rig)
        rig.bus.close()
        rig.engine._thread.join(PATIENCE)
        self.assertFalse(rig.engine._thread.is_alive())
        eventually(lambda: all(link.closed for link in rig.links[-1:]) or rig.refuses)

    def serves(self, rig):
        """The connection that there is, or the next one, serves a command."""
        if rig.link.frozen:  # until its keep-alive ends it
            rig.link.on_down("silent", "other")
        with rig.engine._lock:
            gone = rig.engine._link is None
        if gone or rig.refuses:
            rig.next_link()
        if not rig.engine.session.ready:
            rig.serve()
        eventually(lambda: rig.bus.connected)
        done = threading.Event()
        rig.call(lambda: (rig.bus.board("desk", timeout=PATIENCE).servo.write(0, 17, timeout=PATIENCE), done.set()))
        end = time.monotonic() + PATIENCE
        while not done.is_set() and time.monotonic() < end:
            if not rig.engine.session.catalogue.boards.get("desk"):
                rig.link.tell("asip/servicebus/desk/$description", DESCRIPTION)
            rig.link.answer_all()
            done.wait(0.01)
        self.assertTrue(done.is_set(), "a command that is not executed")

    def calls_functions(self, rig):
        seen = []
        rig.engine.dispatcher.put(seen.append, (1,))
        eventually(lambda: seen)
        rig.bus.board("desk").distance.on_value(seen.append)
        rig.link.tell("asip/desk/distance/out", {"distance": [5, 6]})
        eventually(lambda: [5, 6] in seen)
        rig.bus.timeout = PATIENCE
        rig.call(lambda: rig.bus.board("desk")["io/2"].on_event(seen.append))
        asked = rig.calls[-1][1]
        eventually(lambda: rig.link.answer_all() or asked)
        self.assertIsInstance(asked[0], Watch)
        rig.link.tell("asip/desk/$values", {**VALUES, "seq": 10**6, "values": {"io/2": {"value": True, "how": "reported", "age": 0, "events": [[10**6, "hold"]]}}})
        eventually(lambda: "hold" in seen)

    def test_each_event_at_each_moment(self):
        unraisable = []
        with unittest.mock.patch("threading.excepthook", lambda what: unraisable.append((what.thread.name, what.exc_value))), self.assertLogs("asip", "DEBUG"):
            with concurrent.futures.ThreadPoolExecutor(16) as at_once:  # what takes time is that calls end by their time-outs
                cells = {(moment, event): at_once.submit(self.cell, moment, event) for moment in MOMENTS for event in EVENTS}
            for (moment, event), cell in cells.items():
                with self.subTest(moment=moment, event=event):
                    cell.result()
            self.assertEqual(unraisable, [])
        self.assertEqual([thread.name for thread in threading.enumerate() if thread.name == "asip-clock"], [])

    def test_bus_that_is_closed_while_it_begins_to_connect_leaves_no_connection(self):
        rig = Rig()
        make, made = rig.engine._new_link, []

        def slow(*args):
            rig.bus.close()
            made.append(make(*args))
            return made[-1]
        rig.engine._new_link = slow
        rig.link.on_down("cut", "other")
        eventually(lambda: made)
        rig.engine._thread.join(PATIENCE)
        self.assertIsNone(rig.engine._link)
        self.assertFalse(any(link.sent for link in made))

    def test_functions_that_wait_beyond_the_bound_are_told(self):
        rig, go = Rig(), threading.Event()
        self.addCleanup(rig.bus.close)
        rig.engine.dispatcher.put(go.wait, (5,))
        with self.assertLogs("asip", "ERROR") as logged:
            for _ in range(10_010):
                rig.engine.dispatcher.put(int, ())
        go.set()
        self.assertEqual(len(logged.output), 1)
        self.assertGreater(rig.engine.dispatcher.dropped, 0)


if __name__ == "__main__":
    unittest.main()
