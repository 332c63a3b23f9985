// SPDX-License-Identifier: Apache-2.0
// What the library takes on a Pico: flash and RAM of the image of its pins, and how soon it answers. firmware/README.md has the figures.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { test } from 'node:test'
import { Board, image, ms, us } from './board.mjs'

function sizes(name) {
  const [, line] = execFileSync('arm-none-eabi-size', [image(name)], { encoding: 'utf8' }).split('\n')
  const [text, data, bss] = line.trim().split(/\s+/).map(Number)
  return { flash: text + data, ram: data + bss }
}

// Compilers of Debian 12 and 13 differ by some hundred bytes.
test('flash and RAM, of which the core of the tests has its part', (t) => {
  const { flash, ram } = sizes('asip_pico')
  t.diagnostic(`flash ${flash} bytes, RAM ${ram} bytes`)
  assert.ok(flash <= 9000, `flash ${flash}`)
  assert.ok(ram <= 1400, `RAM ${ram}`)
})

test('request in to event out takes little more than its bytes', (t) => {
  const board = new Board('asip_pico')
  board.watchers.push((pin, level) => pin === 13 && board.driven[2] !== level && board.drive(2, level))
  board.ask('I,P,2,1')
  board.ask('I,P,13,3')
  board.text = ''
  const began = board.now
  board.give('I,d,13,1\n')
  while (!board.text.endsWith('\n') && board.now < began + ms(20)) board.runFor(us(5))
  const took = (board.now - began) / 1e6
  const wire = ((('I,d,13,1\n'.length + board.text.length) * 10) / 57600) * 1e3
  t.diagnostic(`${took.toFixed(2)} ms, its bytes ${wire.toFixed(2)} ms`)
  assert.equal(board.text, '@I,d,0,4\n')
  assert.ok(took < wire + 0.3)
})
