# SPDX-License-Identifier: Apache-2.0
"""Random histories of real gateways, agents and brokers that are killed, boards that are renamed or lose a service, and options that are
taken away. Afterwards as much is retained as where nothing ever happened, and nothing once the exports are cleaned.
ASIP_SEED begins elsewhere, ASIP_HISTORIES says how many."""

import json
import os
import random
import shutil
import signal
import subprocess
import threading
import time
import unittest

from bus import BIN, Bus, can_connect, eventually, paho_client
from scripted_board import ScriptedBoard

HISTORIES = int(os.environ.get("ASIP_HISTORIES", "8"))
STEPS = 12
EXPORTS = ("homeassistant/#", "elsewhere/#", "homie/#", "asip/export/#")
ALL = ("--home-assistant", "--homie", "--wot-mqtt")
OPTIONS = (ALL, ("--home-assistant",), ("--homie",), ("--home-assistant", "elsewhere", "--homie"), ("--homie", "--wot-mqtt"), ())
UNKNOWN = ("None", '{"state":null}')


class LastingBus(Bus):
    """Its broker keeps what is retained over its end. Boards and gateways are started by the history."""

    def start_broker(self):
        config = self.work / "mosquitto.conf"
        config.write_text(f"listener {self.broker_port} 127.0.0.1\nallow_anonymous true\npersistence true\n"
                          f"persistence_location {self.work}/\nautosave_on_changes true\nautosave_interval 1\nuser root\n")
        program = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin")
        self.start("broker", program, "-c", str(config))
        eventually(lambda: can_connect(self.broker_port), "the broker's port")

    def start_gateway(self, *options):
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", *options)

    def start_agent(self, name, board):
        self.start("agent-" + name, "asip-agent", "--tcp", f"127.0.0.1:{board.port}", "--name", name, "--lease", "6", "--patience", "60",
                   "--state-dir", str(self.work / "state" / name))

    def running(self, kind):
        return sorted(name for name in self.programs if name.startswith(kind))

    def retained(self, *filters):
        """Topic -> payload of all that the broker keeps."""
        found, ended = {}, threading.Event()

        def heard(client, _data, message):
            if message.topic == "end/of/it":
                ended.set()
            elif message.retain:
                found[message.topic] = message.payload.decode()

        client = paho_client()
        client.on_message = heard
        client.connect("127.0.0.1", self.broker_port)
        client.subscribe([(each, 1) for each in (*filters, "end/of/it")])
        client.loop_start()
        client.publish("end/of/it", "x", qos=1)
        try:
            if not ended.wait(20):
                raise AssertionError("the broker answers nothing")
        finally:
            client.disconnect()
            client.loop_stop()
        return found

    def clear(self, topics):
        client = paho_client()
        client.connect("127.0.0.1", self.broker_port)
        client.loop_start()
        for topic in topics:
            client.publish(topic, b"", qos=1, retain=True).wait_for_publish(20)
        client.disconnect()
        client.loop_stop()


class History:
    def __init__(self, seed, bus):
        self.random = random.Random(seed)
        self.bus = bus
        self.boards = {}
        self.log = []

    def step(self):
        act = self.random.choice((self.start_gateway, self.start_gateway, self.end_gateway, self.kill_broker, self.kill_agent,
                                  self.rename, self.change_services, self.say, self.say))
        act()
        time.sleep(self.random.choice((0, 0.1, 0.5, 3)))

    def note(self, *words):
        self.log.append(" ".join(map(str, words)))

    def add_board(self, name):
        self.boards[name] = ScriptedBoard(self.random.random() < 0.7)
        self.bus.start_agent(name, self.boards[name])
        self.note("board", name, "distance" if self.boards[name].distance else "")

    def start_gateway(self):
        self.end_gateway()
        options = self.random.choice(OPTIONS)
        self.note("gateway", *options)
        self.bus.start_gateway(*options)

    def end_gateway(self):
        for name in self.bus.running("gateway"):
            how = self.random.choice((signal.SIGKILL, signal.SIGTERM))
            self.note("end gateway", how.name)
            self.bus.end(name, how)

    def kill_broker(self):
        self.note("kill broker")
        time.sleep(1.2)  # it writes down what changed once a second
        self.bus.end("broker", signal.SIGKILL)
        self.bus.start_broker()

    def kill_agent(self):
        name = self.random.choice(sorted(self.boards))
        self.note("kill agent", name)
        self.bus.end("agent-" + name, signal.SIGKILL)
        self.bus.start_agent(name, self.boards[name])

    def forget(self, name):
        self.bus.end("agent-" + name, signal.SIGKILL)
        self.boards.pop(name).close()
        begin = f"asip/servicebus/{name}"
        self.bus.clear([begin, begin + "/$description", begin + "/$state", *self.bus.retained(f"asip/{name}/#")])

    def rename(self):
        old = self.random.choice(sorted(self.boards))
        self.note("forget", old)
        self.forget(old)
        self.add_board(self.random.choice([name for name in ("a", "b", "c", "d") if name not in self.boards]))

    def change_services(self):
        name = self.random.choice(sorted(self.boards))
        self.boards[name].distance = not self.boards[name].distance
        self.note("services", name, self.boards[name].distance)
        self.kill_agent()
        self.bus.end("agent-" + name, signal.SIGKILL)
        self.bus.start_agent(name, self.boards[name])

    def say(self):
        for board in self.boards.values():
            try:
                if board.distance:
                    board.say(f"@D,e,1,{{{self.random.randrange(400)}}}")
                board.say(f"@I,d,4,{self.random.randrange(32):x}")
            except (OSError, AttributeError):
                pass  # no agent is there to hear it

    def known(self):
        """Each board is online, with its services of now."""
        for name, board in self.boards.items():
            descriptions = self.bus.retained(f"asip/servicebus/{name}/#")
            text = descriptions.get(f"asip/servicebus/{name}/$description", "{}")
            services = {each["name"] for each in json.loads(text).get("services", [])}
            if descriptions.get(f"asip/servicebus/{name}/$state") != "online" or ("distance" in services) != board.distance:
                return False
        return True


def settled(retained):
    """What is shown, without how often a document changed, which gateway exports and since when, and states that say only that nothing is
    known."""
    shown = {}
    for topic, payload in retained.items():
        if topic.endswith(("/$lease", "/$sessions")) or payload in UNKNOWN:
            continue
        if topic.endswith(("/$description", "/$gateway")):
            document = json.loads(payload)
            document.pop("started" if topic.endswith("/$gateway") else "version", None)
            payload = json.dumps(document, sort_keys=True)
        shown[topic] = payload
    return shown


class ExportHistories(unittest.TestCase):
    def shown(self, bus, history):
        """What all exports show, once that does not change any more."""
        bus.start_gateway(*ALL)
        topics = [f"homie/5/{name}/$state" for name in history.boards]
        eventually(lambda: all(bus.retained("homie/#").get(topic) == "ready" for topic in topics), "the boards, shown", 60)
        last = None
        while (now := settled(bus.retained(*EXPORTS))) != last:
            last = now
            time.sleep(4)
        return now

    def test_AfterAnyHistory_AsMuchIsRetainedAsAfterNone(self):
        first = int(os.environ.get("ASIP_SEED", "1"))
        for seed in range(first, first + HISTORIES):
            with self.subTest(seed=seed):
                self.history(seed)
                print(f"history {seed} is as if nothing had happened", flush=True)

    def history(self, seed):
        bus = LastingBus(boards=())
        history = History(seed, bus)
        try:
            for name in ("a", "b"):
                history.add_board(name)
            for _ in range(STEPS):
                history.step()
            history.end_gateway()
            eventually(history.known, "the boards as they are", 60)
            after = self.shown(bus, history)
            bus.end("gateway")
            subprocess.run([str(BIN / "asip-gateway"), "clean", "--broker", f"127.0.0.1:{bus.broker_port}"], check=True, timeout=120,
                           capture_output=True)
            self.assertEqual(bus.retained(*EXPORTS), {}, history.log)
            fresh = self.shown(bus, history)
            states = {topic: payload for topic, payload in after.items() if topic not in fresh}
            # A board says a value when it changes; what it said before is known to the gateway that heard it, and still right.
            for topic in [topic for topic in states if topic.rsplit("/", 1)[-1].startswith(("io-", "distance-"))]:
                board = topic.split("/")[2 if topic.startswith("homie") else 3]
                self.assertIn(board, history.boards, (topic, history.log))
                del after[topic]
            self.assertEqual(after, fresh, history.log)
        except BaseException:
            print(f"seed {seed}:", *history.log, sep="\n  ")
            print(bus.logs())
            raise
        finally:
            for board in history.boards.values():
                board.close()
            bus.close()


if __name__ == "__main__":
    unittest.main()
