# SPDX-License-Identifier: Apache-2.0
"""What is made at run time: services of models, help, tables, plots, and the names of asip.aio."""
import copy
import importlib.util
import inspect
import json
import pathlib
import pydoc
import sys
import threading
import time
import unittest
import unittest.mock

import asip
from asip import aio
from asip import _model
from asip.service import class_of, identifier_of_class
from asip.stubs import module_text as stubs_text
from memory_rig import Memory

MODELS = pathlib.Path(asip.__file__).parent / "models"


class Dynamic(Memory):
    def test_typos_are_errors_with_a_hint_and_probes_are_quiet(self):
        with self.assertRaises(AttributeError) as raised:
            self.desk.sevro
        self.assertIn("servo", str(raised.exception))
        with self.assertRaises(AttributeError) as raised:
            self.desk.servo.wirte(0, 1)
        self.assertIn("write", str(raised.exception))
        for thing in (self.desk, self.desk.servo):
            self.assertFalse(hasattr(thing, "_ipython_canary_method_should_not_exist_"))
            self.assertIn("write" if thing is self.desk.servo else "servo", dir(thing))
            copy.copy(thing)
        with self.assertRaises(LookupError):
            self.desk["nothing"]

    def test_help_shows_the_model(self):
        self.assertEqual(str(inspect.signature(self.desk.servo.write)), "(servo: 'int', angle: 'int', *, timeout: 'float | None' = None)")
        self.assertIn("0 to 180 degrees", self.desk.servo.write.__doc__)

    def test_stubs_are_the_classes_made_at_run_time(self):
        hostile = {"name": "class.new-int", "version": 1, "id": "Y", "title": 'quotes """ and \\ ends', "commands": {
            "read": {"tag": "R"}, "import": {"tag": "I", "args": [{"name": "lambda", "type": "text"}]}}}
        models = [*(_model.Model(json.loads(file.read_text())) for file in MODELS.glob("*.json") if file.stem != "schema"), _model.Model(hostile)]
        stubs = {"__name__": "lab"}
        exec(stubs_text(models), stubs)
        self.assertEqual(stubs["Board"].__annotations__["servo"], "Servo")
        self.assertGreater(len(models), 15)
        for model in models:
            static, dynamic = stubs[identifier_of_class(model.name)], class_of(model)
            own = {attribute for attribute in vars(static) if not attribute.startswith("_")}
            self.assertEqual(own, {attribute for attribute in vars(dynamic) if not attribute.startswith("_") and attribute != "model"})
            for attribute in own:
                self.assertEqual(list(inspect.signature(getattr(static, attribute)).parameters), list(inspect.signature(getattr(dynamic, attribute)).parameters))
                self.assertEqual(inspect.getdoc(getattr(static, attribute)), inspect.getdoc(getattr(dynamic, attribute)))

    def test_help_in_words_a_pupil_reads(self):
        text = pydoc.plain(pydoc.render_doc(self.desk.servo.write)).replace("'", "")  # Python before 3.14 puts annotations into quotes
        for words in ("write(servo: int, angle: int, *, timeout", "servo: integer, 0 to", "angle: integer, 0 to 180 degrees", "Returns when the board has executed it."):
            self.assertIn(words, text)

    def test_boards_and_buses_are_tables(self):
        table = self.desk._repr_html_()
        self.assertIn("<td>distance</td>", table)
        self.assertIn("<td>distance (cm)</td>", table)
        self.assertIn("write(servo, angle)", table)
        self.assertIn("<td>lamp</td>", self.bus._repr_html_())


LIGHTS = {"name": "lights", "version": 3, "id": "Z", "title": "Lights", "commands": {
    "shine": {"tag": "S", "args": [{"name": "lamp", "type": "integer", "min": 0, "max": 3}]}}}


class Models(Memory):
    """A service that only its name and version describe, on a board that another program announces."""

    def announce(self, reference):
        self.memory._publish("servicebus/shed/$description", {"board": "shed", "session": "1", "seq": 1, "lease": 600, "services": [
            {"name": "lights", "id": "Z", "model": reference}]}, retained=True)
        self.memory._publish("servicebus/shed/$state", "online", retained=True)

    def test_a_registry_tells_the_model_that_the_package_lacks(self):
        self.memory.registry_models = [{**LIGHTS, "version": 2}, LIGHTS]
        self.announce("lights@3")
        lights = self.bus.board("shed").lights
        self.assertEqual(str(inspect.signature(lights.shine)), "(lamp: 'int', *, timeout: 'float | None' = None)")
        with self.assertRaises(asip.Invalid):
            lights.shine(4)
        other = self.memory.connect()
        self.assertIn("shine", dir(next(one for one in other.boards("sh*"))["lights"]))

    def test_without_such_a_model_the_service_says_what_can_be_done(self):
        self.memory.registry_models = [{"name": "lights"}, {**LIGHTS, "commands": 7}, {**LIGHTS, "version": 2}]
        self.announce("lights@3")
        began = time.monotonic()
        for _ in range(3):
            with self.assertRaises(asip.Invalid) as raised:
                self.bus.board("shed").lights.command("shine", 1)
            self.assertIn("board.raw()", str(raised.exception))
        self.assertLess(time.monotonic() - began, 5)

    def test_bus_without_a_registry(self):
        self.memory._asked = lambda query: None
        self.announce("lights@3")
        self.assertEqual(list(self.bus.board("shed").services), ["lights"])
        self.bus.board("desk").servo.write(0, 90)  # the package's own copy


class WithoutRegistry(Memory):
    """What the broker keeps is all that is known of the boards."""

    def late(self):
        """A broker that sends what it keeps as late as it may: right before what is published behind the subscription."""
        link, kept, ask = self.bus._engine._link, [], self.memory._received
        offer = link._on_message
        link._on_message = lambda topic, payload, retained, expiry: kept.append((topic, payload)) if retained else offer(topic, payload, retained, expiry)

        def received(topic, payload):
            if topic.endswith("/$self/" + self.bus._engine.client):
                for one in kept:
                    offer(*one, True, None)
                kept.clear()
            ask(topic, payload)
        self.memory._received = received
        self.memory._asked = lambda query: None

    def test_a_slow_broker_s_boards_are_all_there(self):
        self.late()
        self.assertEqual([one.name for one in self.bus.boards()], ["desk", "lamp"])

    def test_boards_that_the_broker_forgot_are_not_there(self):
        self.bus.boards()  # as the registry lists them
        self.memory._asked = lambda query: None
        for name in ("$state", "$description"):
            del self.memory._retained[f"asip/servicebus/lamp/{name}"]
        self.assertEqual([one.name for one in self.bus.boards()], ["desk"])

    def test_a_broker_that_does_not_tell_all_is_an_error(self):
        received = self.memory._received
        self.memory._asked = lambda query: None
        self.memory._received = lambda topic, payload: None if "$self" in topic else received(topic, payload)
        with self.assertRaises(asip.Disconnected) as raised:
            self.bus.boards(timeout=0.1)
        self.assertEqual(str(raised.exception), "the broker did not tell within 0.1 s which boards there are")
        with self.assertRaisesRegex(asip.NotThere, 'there is no board "desc"; did you mean "desk"'):
            self.bus.board("desc", timeout=0.1)


class Plots(Memory):
    def test_without_matplotlib_the_error_says_how_to_get_it(self):
        with unittest.mock.patch.dict(sys.modules, {"matplotlib": None, "matplotlib.pyplot": None}):
            with self.assertRaises(ModuleNotFoundError) as raised:
                self.desk.distance.plot(seconds=1)
        self.assertIn("apt install python3-matplotlib", str(raised.exception))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_a_line_for_each_number(self):
        import matplotlib
        matplotlib.use("Agg")
        told = threading.Event()

        def report():
            for number in range(20):
                self.memory.desk.report("distance", [number, None, 7])
                told.wait(0.02)
        threading.Thread(target=report).start()
        axes = self.desk.distance.plot(seconds=0.7, hz=50)
        lines = {line.get_label(): list(line.get_ydata()) for line in axes.get_lines()}
        self.assertEqual(sorted(lines), ["0", "2"])
        self.assertEqual(lines["0"], sorted(lines["0"]))
        self.assertGreater(len(lines["0"]), 5)
        self.assertEqual(axes.get_ylabel(), "cm")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_a_board_that_reports_nothing_is_asked(self):
        import matplotlib
        matplotlib.use("Agg")
        self.memory.desk._values["distance", "distance"] = [42, 0]
        axes = self.desk.distance.plot(seconds=0.6)
        self.assertIn(42.0, axes.get_lines()[0].get_ydata())
        with self.assertRaises(asip.Unproven):
            self.desk.io.plot(seconds=0.2)


class Twins(unittest.TestCase):
    def test_asynchronous_names_have_the_same_arguments(self):
        pairs = [(asip.Bus, aio.Bus, {"on_error", "run"}), (asip.Board, aio.Board, set()), (asip.Service, aio.Service, {"begin", "plot"}),
                 (asip.Pin, aio.Pin, {"when_changed"}), (asip.Property, aio.Property(None, unittest.mock.Mock(spec=asip.Property, id="a/b")), {"value"})]
        for sync, other, missing in pairs:
            for name, member in inspect.getmembers(sync):
                if name.startswith("_") or name in missing:
                    continue
                self.assertTrue(hasattr(other, name), f"{other!r}.{name}")
                if inspect.isfunction(member) and name not in ("board",):
                    twin = [*inspect.signature(getattr(other, name)).parameters]
                    self.assertEqual([one for one in inspect.signature(member).parameters if one != "self"], [one for one in twin if one != "self"], name)


if __name__ == "__main__":
    unittest.main()
