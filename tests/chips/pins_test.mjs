// SPDX-License-Identifier: Apache-2.0
// Pins as an ESP has them, on a Pico: 6 to 11 are hidden, as those of its flash; 26 to 29 have a converter and no port, as A0 has.
import assert from 'node:assert/strict'
import { test } from 'node:test'
import { Board } from './board.mjs'

const HIDDEN = [6, 7, 8, 9, 10, 11]

test('hidden pins are never touched, and nobody gets them', () => {
  const board = new Board('asip_pico_odd_pins')
  const before = HIDDEN.map((pin) => [board.rp2040.gpio[pin].ctrl, board.rp2040.gpio[pin].padValue])
  board.ask('#,R')
  for (const pin of HIDDEN) {
    assert.equal(board.ask(`I,P,${pin},3`), '~I,P,4{MODE_UNAVAILABLE}')
    assert.equal(board.ask(`I,a,${pin},9`), '~I,a,3{INVALID_PIN}')
    assert.equal(board.ask(`I,d,${pin},1`), '~I,d,6{WRONG_MODE}')
    board.drive(pin, true)
  }
  board.run(20)
  assert.equal(board.text, '', 'no port reports them')
  const after = HIDDEN.map((pin) => [board.rp2040.gpio[pin].ctrl, board.rp2040.gpio[pin].padValue])
  assert.deepEqual(after, before)
  // As the chip has them after a reset, but for the function that the core gives every pin.
  assert.ok(after.every(([, pad]) => pad === 0b0110110 || pad === 0x56), String(after))
})

test('converters without a port are pins that measure only', () => {
  const board = new Board('asip_pico_odd_pins')
  assert.equal(board.ask('#,?'), '@#,?,0,4,RP2040,30,AsipPlainSerial')
  assert.ok(board.ask('I,c').endsWith(',5,5,2,2,2,2}'))
  assert.ok(board.ask('I,M').endsWith(',3:1,3:2,0:0,0:0,0:0,0:0}'))
  assert.equal(board.ask('I,P,26,3'), '~I,P,4{MODE_UNAVAILABLE}')
  board.setAnalog(1, 2048)
  board.ask('I,A,20')
  assert.equal(board.nextLine(), '@I,a,4,{0:0,1:512,2:0,3:0}')
})
