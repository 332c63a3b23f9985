# SPDX-License-Identifier: Apache-2.0
"""How a board stands, over a bus in memory: no read sets anything, whoever set it before."""
import threading
import time
import unittest

import asip
from asip.testing import eventually
from memory_rig import Memory


class Pins(Memory):
    def as_set(self, pin, **done):
        """Another program sets a pin of the desk: mode=3, write=1, pwm=128."""
        for command, value in done.items():
            self.memory.desk._set_pin(command, [pin, value])

    def test_reading_sets_nothing_whatever_the_pin_is(self):
        self.as_set(13, mode=3, write=1)
        self.as_set(3, pwm=128)
        self.as_set(12, mode=3)
        self.as_set(4, mode=2)
        self.memory.desk.press(4)
        seen, desk = [], self.memory.connect(timeout=5).board("desk")
        self.assertIs(desk.pin(13).read(), True)
        self.assertEqual(desk.pin(3).read(), 128)
        with self.assertRaises(asip.Unproven) as raised:
            desk.pin(12).read()
        self.assertIn("nothing was reported or set yet", str(raised.exception))
        desk.pin(13).wait_for(True, timeout=5)
        desk.pin(13).on_change(seen.append, initial=True)
        desk.pin("A0").when_changed = seen.append
        for call in (lambda: desk.pin(2).read(), lambda: desk.pin("A1").wait_for(True), lambda: desk.pin(3).wait_for(True)):
            with self.assertRaises(asip.Invalid) as raised:
                call()
            self.assertIn('.mode("input-pullup")', str(raised.exception))
        self.assertIs(desk.pin(4).read(), True)
        self.assertEqual(self.commands(), [])
        self.as_set(13, write=0)
        eventually(lambda: seen == [True, False])
        self.assertIs(desk.pin(13).read(), False)
        self.assertEqual(self.commands(), [])

    def test_toggle_works_from_what_any_program_set(self):
        self.as_set(13, mode=3, write=1)
        self.desk.pin(13).toggle()
        self.assertEqual(self.commands(), [("io", "write", [13, 0])])
        self.as_set(13, write=1)
        eventually(lambda: self.desk.pin(13).read() is True)
        self.desk.pin(13).toggle()
        self.desk.pin(13).toggle()
        self.assertEqual(self.memory.desk.levels[13], 1)
        self.desk.pin(7).toggle()  # nothing was set on it
        self.assertEqual(self.commands()[-2:], [("io", "mode", [7, 3]), ("io", "write", [7, 1])])

    def test_input_keeps_the_mode_that_another_program_gave_it(self):
        self.as_set(4, mode=1)
        self.memory.desk.press(4)
        self.desk.pin(4).wait_for(True, timeout=5)
        self.assertIs(self.desk.pin(4).read(), True)
        self.memory.desk.press(4, 0)
        self.desk.pin(4).wait_for(False, timeout=5)
        self.assertEqual(self.commands(), [])  # its agent knows the level

    def test_read_of_an_input_that_the_program_made(self):
        button = self.desk.pin(2)
        button.mode("input-pullup")
        self.assertIs(button.read(), False)
        self.memory.desk.press(2)
        eventually(lambda: button.read() is True)

    def test_analog_pin_by_name(self):
        knob = self.desk.pin("A0")
        self.assertEqual((knob.number, self.desk.pin("A5").number), (14, 19))
        with self.assertRaises(asip.Invalid):
            self.desk.pin("A6")
        with self.assertRaises(asip.Unproven):
            knob.read(timeout=0.1)
        threading.Timer(0.1, lambda: self.memory.desk.report("io", {"0": 512, "1": 3}, "analog")).start()
        self.assertEqual(knob.read(timeout=5), 512)
        seen = []
        knob.when_changed = seen.append
        for value in (512, 512, 600):
            self.memory.desk.report("io", {"0": value}, "analog")
        eventually(lambda: seen == [600])
        self.assertEqual(self.commands(), [])

    def test_returning_board_whose_input_became_an_output_meanwhile_keeps_it(self):
        button = self.desk.pin(2)
        button.mode("input-pullup")
        self.memory.desk.lose()
        eventually(lambda: self.desk.state == "lost")
        self.as_set(2, mode=3, write=1)
        self.memory.desk.back()
        self.desk.wait_for("online")
        self.assertIs(button.read(), True, "the agent sets levels of outputs again")
        self.as_set(2, write=0)
        self.assertIs(button.read(), False)
        self.desk.servo.write(0, 1)
        self.assertEqual(self.memory.desk.modes[2], 3)

    def test_what_was_set_ends_when_the_board_restarts(self):
        self.as_set(13, mode=3, write=1)
        lamp = self.desk.pin(13)
        self.assertIs(lamp.read(), True)
        self.memory.desk.lose()
        self.desk.wait_for("lost")
        self.memory.desk.modes.clear()
        self.memory.desk.back()
        self.desk.wait_for("online")
        with self.assertRaises(asip.Unproven) as raised:
            lamp.read()
        self.assertIn("since the board came back", str(raised.exception))
        lamp.on()
        self.assertEqual(self.commands(), [("io", "mode", [13, 3]), ("io", "write", [13, 1])])
        self.memory.desk.lose()
        self.memory.desk.back()
        self.desk.wait_for("online")
        self.assertIs(lamp.read(), True, "the agent sets levels of outputs again")

    def test_read_sees_each_command_that_was_answered_before_and_many_reads_at_once_are_few_questions(self):
        asked, questioned = [], self.memory.desk._questioned
        self.memory.desk._questioned = lambda services: asked.append(services) or questioned(services)
        lamp = self.desk.pin(13)
        for number in range(30):
            self.as_set(13, write=number % 2) if number % 3 else lamp.write(number % 2)
            self.assertIs(lamp.read(timeout=5), bool(number % 2), number)
        began, done = time.monotonic(), []
        readers = [threading.Thread(target=lambda: done.append(lamp.read(timeout=5))) for _ in range(100)]
        for reader in readers:
            reader.start()
        for reader in readers:
            reader.join()
        self.assertEqual(done, [True] * 100)
        self.assertLess(len(asked), 70)
        self.assertLess(time.monotonic() - began, 3)

    def test_level_of_an_input_is_read_in_a_fast_loop(self):
        button = self.desk.pin(2)
        button.mode("input-pullup")
        began = time.monotonic()
        for number in range(500):
            self.assertIs(button.read(), False)
        self.assertLess(time.monotonic() - began, 3)

    def test_agent_that_does_not_tell_how_its_board_stands(self):
        self.memory.desk._questioned = lambda services: None
        with self.assertRaises(asip.Unproven) as raised:
            self.desk.pin(13).read(timeout=0.3)
        self.assertIn("update asip-agent", str(raised.exception))
        self.assertEqual(self.commands(), [])
        self.desk.pin(13).on()  # without it, too
        self.assertEqual(self.memory.desk.levels[13], 1)


class Properties(Memory):
    def setUp(self):
        super().setUp()
        self.memory.desk.offer("servo/0/angle", "number", min=0, max=180, unit="degrees", write=["write", 0, None])
        self.memory.desk.offer("distance/0", "sensor", unit="cm")
        self.memory.desk._set_pin("mode", [13, 3])
        self.memory.desk._set_pin("write", [13, 1])

    def test_list_and_values(self):
        self.assertEqual([(one.id, one.type, one.access, one.unit) for one in self.desk.properties],
                         [("servo/0/angle", "integer", "both", "degrees"), ("distance/0", "integer", "read", "cm"), ("io/13", "boolean", "both", "")])
        lamp = self.desk["io/13"]
        self.assertEqual((lamp.value, lamp.how, lamp.text, lamp.why), (True, "set", "on", ""))
        self.assertLess(lamp.age, 1)
        with self.assertRaises(asip.Unproven) as raised:
            self.desk["servo/0/angle"].read()
        self.assertIn("nothing was reported or set yet", str(raised.exception))
        self.memory.desk.report("distance", [42, 0])
        self.assertEqual((self.desk["distance/0"].value, self.desk["distance/0"].text), (42, "42 cm"))
        with self.assertRaises(asip.NotThere) as raised:
            self.desk["servo/0/angel"]
        self.assertIn("did you mean", str(raised.exception))
        self.assertEqual(self.commands(), [])

    def test_pin_that_nothing_holds_is_refused_at_once(self):
        self.memory.desk.offer("io/4", "binary", read="/digital/4", choices=[["off", 0], ["on", 1]], floating=True)
        began = time.monotonic()
        for read in (self.desk["io/4"].read, self.desk.pin(4).read):
            with self.assertRaises(asip.Invalid) as raised:
                read(timeout=20)
            self.assertIn('pin(4).mode("input-pullup") makes it an input', str(raised.exception))
        self.assertLess(time.monotonic() - began, 10)
        self.assertEqual(self.commands(), [])

    def test_write(self):
        self.desk["servo/0/angle"].value = 90
        self.assertEqual((self.desk["servo/0/angle"].value, self.commands()), (90, [("servo", "write", [0, 90])]))
        self.desk["io/13"].write(False)
        self.assertEqual((self.memory.desk.levels[13], self.desk.pin(13).read()), (0, False))
        for id, bad in (("servo/0/angle", 181), ("servo/0/angle", "90"), ("io/13", "on"), ("distance/0", 1)):
            with self.assertRaises(asip.Invalid):
                self.desk[id].value = bad
        self.assertEqual(len(self.commands()), 2)

    def test_meaning_turns_the_value_and_not_the_level(self):
        self.desk.set_meaning("io/2", "door", inverted=True)
        self.memory.desk.press(2)
        door = self.desk["io/2"]
        self.assertEqual((door.value, door.text, door.meaning), (False, "closed", {"class": "door", "inverted": True}))
        self.assertIs(self.desk.pin(2).read(), True)
        self.desk.set_meaning("io/2", inverted=False)
        self.assertEqual((door.value, door.text), (True, "open"))
        self.desk.set_meaning("io/13", inverted=True)
        self.assertEqual((self.desk["io/13"].value, self.desk.pin(13).read()), (False, True))
        self.desk["io/13"].value = True
        self.assertEqual((self.memory.desk.levels[13], self.desk.pin(13).read()), (0, False))
        self.desk.set_meaning("io/2", None)
        with self.assertRaises(asip.NotThere):
            door.read()
        with self.assertRaises(asip.Invalid):
            self.desk.set_meaning("io/2")

    def test_changes_are_told(self):
        seen = []
        self.desk["io/13"].on_change(seen.append)
        eventually(lambda: seen == [True])
        self.memory.desk._set_pin("write", [13, 0])
        eventually(lambda: seen == [True, False])
        self.desk["io/13"].on_change(None)
        self.memory.desk._set_pin("write", [13, 1])
        self.assertIs(self.desk["io/13"].value, True)
        self.assertEqual(seen, [True, False])

    def test_none_is_a_value(self):
        seen = []
        self.memory.desk.offer("distance/0", "sensor", unit="cm", read="/distance/0", none=0)
        self.desk["distance/0"].on_change(seen.append)
        for distance in (42, None, 7):
            self.memory.desk.report("distance", [distance or 0, 0])
            eventually(lambda: seen[-1:] == [distance])
            self.assertEqual((self.desk["distance/0"].read(), self.desk["distance/0"].text), (distance, "none" if distance is None else f"{distance} cm"))
        self.assertEqual(seen, [42, None, 7])

    def test_contradiction_is_refused_in_a_sentence_and_nothing_is_sent(self):
        self.desk.set_meaning("io/7", "plug")
        self.desk["io/7"].value = True
        self.desk.pin(7).mode("input-pullup")
        before = len(self.commands())
        with self.assertRaisesRegex(asip.Refused, "^desk/io/7: a command made pin 7 no output, and plug needs one: asipctl pin desk 7 output$") as raised:
            self.desk["io/7"].value = True
        self.assertIs(raised.exception.sent, False)
        self.assertEqual(len(self.commands()), before)
        self.desk.pin(7).mode("output")
        self.desk["io/7"].value = True
        self.assertEqual(self.memory.desk.levels[7], 1)

    def test_what_is_done_with_a_button_is_told_once(self):
        with self.assertRaisesRegex(asip.Invalid, "no button"):
            self.desk["io/13"].on_event(print)
        self.desk.set_meaning("io/2", "button")
        self.memory.desk.press(2)  # before anybody listens
        button, seen = self.desk["io/2"], []
        watch = button.on_event(seen.append)
        changes = []
        button.on_change(changes.append)
        with button.events() as events:
            self.memory.desk.press(2, 0)
            self.memory.desk.press(2, 0)
            self.memory.desk.button(2, "hold")
            self.assertEqual([next(events), next(events)], ["press", "hold"])
            self.memory.cut()
            eventually(lambda: self.bus.connected)
            self.assertIs(button.read(), True)
            self.memory.desk.lose()
            self.memory.desk.back()
            self.desk.wait_for("online")
            self.memory.desk.press(2)
            self.assertEqual(next(events), "release")
        eventually(lambda: seen == ["press", "hold", "release"])
        self.assertEqual(changes, [False, True, False])
        watch.cancel()
        self.memory.desk.press(2, 0)
        eventually(lambda: changes[-1] is True)
        self.assertEqual((seen, self.desk._bank.button_sinks), (["press", "hold", "release"], {"io/2": []}))
        with self.assertRaisesRegex(asip.Unproven, "desk/io/2: no value within 0.05 s"):
            next(button.events(timeout=0.05))
        self.assertEqual(self.commands(), [])

    def test_of_a_board_that_is_away(self):
        self.memory.desk.lose()
        self.desk.wait_for("lost")
        lamp = {one.id: one for one in self.desk.properties}["io/13"]
        self.assertEqual((lamp.text, lamp.how), ("on", "set"))  # its last value
        with self.assertRaises(asip.NotThere):
            lamp.read()
        self.memory.desk.modes.clear()
        self.memory.desk.back()
        self.desk.wait_for("online")
        with self.assertRaises(asip.Unproven) as raised:
            lamp.read()
        self.assertIn("came back", str(raised.exception))

    def test_damaged_documents_are_counted_and_the_next_one_works(self):
        lamp = self.desk["io/13"]
        good = lamp.value
        faults = self.bus._engine.faults
        for topic in ("servicebus/desk/$properties", "desk/$values"):
            for document in ({"version": 1}, {"version": 1, "board": "desk", "session": "x", "seq": 10**6, "values": [], "properties": 7}, {"version": 2}):
                self.memory._publish(topic, document)
            self.memory._publish(topic, "[[[")
        eventually(lambda: self.bus._engine.faults == faults + 6)
        self.assertIs(lamp.value, good)
        self.memory.desk._set_pin("write", [13, 0])
        self.assertIs(lamp.value, False)


if __name__ == "__main__":
    unittest.main()
