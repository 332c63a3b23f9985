// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { blinks, light_of } from "../../../gateway/page/core/identify.js";
import { qr_of } from "../../../gateway/page/core/qr.js";

const drawn = (text) => qr_of(text).map((row) => row.map((dark) => (dark ? "#" : ".")).join(""));

// Made by the program "qrcode" 8 of Python, of level L with mask 0.
test("AddressOfALesson_IsTheQrCodeThatOtherProgramsMakeOfIt", () => {
  assert.deepEqual(drawn("http://192.168.178.123:8080/#/join/CDF347"), [
    "#######...#...#..#.##.#######", "#.....#..#...####..##.#.....#", "#.###.#.#..#..###.###.#.###.#", "#.###.#..#..####...##.#.###.#",
    "#.###.#..#..#.#..#.##.#.###.#", "#.....#...###.####.#..#.....#", "#######.#.#.#.#.#.#.#.#######", "........#..#.#..##...........",
    "###.#####...#######..##...#..", "##.##...##.####..##...##.#..#", "#.#...#...#####.#.#..####.###", "..####.#.##.###.##.#.###.#.#.",
    "#..##.###.##.######...##.#.##", "####......##.##.#.#...##.##.#", ".##...#.##........#.#......##", ".##.#....#.#.#.#.#..##..##.#.",
    "..#.#####.#.#########.#....##", ".#####.###.####.###..###..#.#", "#.#..##.######....#.##...#.##", ".##.#..#..#.###.##.#.###.#.#.",
    "#.#...###..#..###########....", "........#.##....#...#...#.###", "#######.###..#..##.##.#.##.##", "#.....#.####.....####...##...",
    "#.###.#.#...#..####.######...", "#.###.#....###..##..##..##.##", "#.###.#.#.###.#..#####..###.#", "#.....#.###.###.###.##...#.#.",
    "#######.####..#####.###..#.##"]);
  assert.equal(drawn("a").join("\n"), [
    "#######..#.##.#######", "#.....#..###..#.....#", "#.###.#.##.##.#.###.#", "#.###.#..#.#..#.###.#", "#.###.#...#.#.#.###.#", "#.....#.....#.#.....#",
    "#######.#.#.#.#######", "........##.##........", "###.########.##...#..", "..#.##.#..#...#...##.", "....#.#####.#...#...#", "##.#.#...##...#...#..",
    "##..####....#.#.#.#.#", "........##.#.#.#.#.##", "#######.#..#.###.####", "#.....#.######.###...", "#.###.#.#.##.###.##.#", "#.###.#...#...#...##.",
    "#.###.#.##..#...#...#", "#.....#.##....#...##.", "#######.##..#.#.#.###"].join("\n"));
});

test("AddressThatIsTooLong_HasNoQrCode", () => {
  assert.equal(qr_of("x".repeat(106)).length, 37);
  assert.equal(qr_of("x".repeat(107)), undefined);
  assert.equal(qr_of("ü".repeat(54)), undefined, "bytes count");
});

const uno = (more) => ({ chip: "ATmega328P", description: { pins: { capabilities: "11151511155511333333", owners: "@@IIIIIIIIIIIIIIIIII", modes: "66111111111111444444" }, services: [{ name: "io", id: "I" }], ...more } });
const output = { pins: { ...uno().description.pins, modes: "66111111111113444444" } };

test("LightOfAnUno_IsAtPin13_WhichBecomesAnOutputOnlyWhereNobodyUsesIt", () => {
  assert.deepEqual(light_of(uno(), []), { pin: 13, output: false });
  assert.deepEqual(light_of(uno(output), [{ id: "io/13", kind: "switch" }]), { pin: 13, output: true });
  for (const [board, properties] of [
    [uno({ pin_modes: { 13: 2 } }), []],
    [uno(), [{ id: "io/13", kind: "binary", meaning: { class: "button" } }]],
    [uno({ pins: { ...uno().description.pins, owners: "@@IIIIIIIIIIISIIIIII" }, services: [{ name: "servo", id: "S" }] }), []],
  ]) assert.match(light_of(board, properties).refused, /pin 13, which is in use for something else/);
});

test("LightThatAPersonNamed_IsTheOne", () => {
  const board = uno({ pins: { ...uno().description.pins, modes: "66111311111111444444" } });
  assert.deepEqual(light_of(board, [{ id: "io/5", kind: "switch", meaning: { class: "light" } }]), { pin: 5, output: true });
});

test("BoardWithoutALight_IsRefusedWithASentence", () => {
  for (const board of [undefined, {}, { chip: "esp32", description: uno().description }, { chip: "ATmega328P", description: {} }])
    assert.match(light_of(board, []).refused, /no light that is known/);
});

test("Blinking_EndsAsItWas", () => {
  assert.deepEqual(blinks({ pin: 13, output: false }, false, 1), [["mode", [13, "output"]], ["write", [13, 1]], ["write", [13, 0]]]);
  assert.deepEqual(blinks({ pin: 13, output: true }, true, 1), [["write", [13, 1]], ["write", [13, 0]], ["write", [13, 1]]]);
});
