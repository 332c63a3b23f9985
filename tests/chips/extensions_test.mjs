// SPDX-License-Identifier: Apache-2.0
// The extensions E, V, I, B, C, D on a Pico.
import assert from 'node:assert/strict'
import { mkdtempSync, readFileSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { test } from 'node:test'
import { Board, image, ms } from './board.mjs'

test('E and V: a fence, and the digest of what was read', () => {
  const board = new Board('asip_pico')
  assert.equal(board.ask('#,X'), '@#,X,7,{E:1,I:1,B:1,C:1,V:1,D:1,F:2}')
  assert.equal(board.ask('#,E,abc'), '@#,E,abc')
  board.ask('#,V,a')
  assert.equal(board.ask('I,d,13,1\n#,V,b'), board.ask('I,d,13,1\n#,V,b'), 'the same lines, the same digest')
})

test('I: the name is in the flash and outlives resets, loads and starts', () => {
  const folder = mkdtempSync(join(tmpdir(), 'asip-pico-'))
  const eeprom = join(folder, 'flash')
  try {
    const board = new Board('asip_pico', { eeprom })
    assert.equal(board.ask('#,I'), '@#,I,')
    assert.equal(board.ask('#,I,living-room.2'), '@#,I,living-room.2')
    board.reset()
    board.boot()
    assert.equal(board.ask('#,I'), '@#,I,living-room.2')
    assert.equal(board.ask('#,I,x'), '@#,I,x', 'a shorter one, over the longer')
    board.load(image('asip_pico_services'))
    board.boot()
    assert.equal(board.ask('#,I'), '@#,I,x')
    const stored = readFileSync(eeprom)
    assert.equal(stored.length, 4096)
    assert.ok(stored.subarray(0, 512 - 34).every((byte) => byte === 0xff), 'what sketches keep is untouched')
    assert.equal(new Board('asip_pico', { eeprom }).ask('#,I'), '@#,I,x')
  } finally {
    rmSync(folder, { recursive: true })
  }
})

test('I: reports go on while a name is stored', () => {
  const board = new Board('asip_pico')
  board.ask('I,A,50')
  board.give('#,I,desk\n')
  const lines = board.linesWithin(ms(500))
  assert.equal(lines.filter((line) => line === '@#,I,desk').length, 1)
  const reports = lines.filter((line) => line.startsWith('@I,a')).length
  assert.ok(reports >= 8, `${reports} reports`)
})

for (const baud of [115200, 250000, 500000, 1000000])
  test(`B: at ${baud} baud`, () => {
    const board = new Board('asip_pico')
    board.give(`#,B,${baud}\n`)
    assert.equal(board.nextLine(), `@#,B,${baud}`)
    board.run(2)
    assert.ok(Math.abs(board.uart.baud / baud - 1) < 0.01)
    for (let i = 0; i < 20; i++) assert.ok(board.ask('I,M').startsWith('@I,M,30,'))
    board.run(1000)
    assert.equal(board.ask('#,E,still'), '@#,E,still')
    assert.equal(board.uart.overruns, 0)
  })

test('B: without a fence at the new rate the old one is back after half a second', () => {
  const board = new Board('asip_pico')
  board.give('#,B,500000\n')
  board.run(20)
  assert.equal(Math.round(board.uart.baud), 500000)
  board.run(520)
  assert.ok(Math.abs(board.uart.baud / 57600 - 1) < 0.01)
  board.text = ''
  assert.equal(board.ask('#,E,back'), '@#,E,back')
})

test('B: a rate that is none is refused', () => {
  const board = new Board('asip_pico')
  for (const rate of ['57601', '2000000', 'x', '1200'])
    assert.equal(board.ask(`#,B,${rate}`), '~#,B,11{BAD_ARGUMENT}', rate)
})

test('C: a damaged request is refused, and the next one works', () => {
  const board = new Board('asip_pico')
  board.give('#,C,1\n#,E,ok*62\n')
  assert.equal(board.nextLine(), '@#,E,ok*22')
  board.give('#,E,oj*62\n')
  assert.equal(board.nextLine(), '~#,C,10{BAD_CHECKSUM}*0C')
  board.give('#,E,ok*62\n')
  assert.equal(board.nextLine(), '@#,E,ok*22')
})

test('a flood is executed whole or refused, and the board answers behind it', () => {
  const board = new Board('asip_pico')
  board.ask('I,P,12,3')
  board.give('#,B,1000000\n')
  board.run(20)
  board.give('I,d,12,1\n#,?\nI,M\n'.repeat(300))
  board.run(400)
  board.text = ''
  for (const pin of [2, 3, 13, 14, 22]) assert.equal(board.level(pin), false, `pin ${pin}`)
  board.give('\n')
  board.run(5)
  board.text = ''
  assert.equal(board.ask('#,E,ok'), '@#,E,ok')
})
