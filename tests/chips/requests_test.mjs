// SPDX-License-Identifier: Apache-2.0
// The requests of the differential test and the bytes of published clients, on a Pico.
import assert from 'node:assert/strict'
import { test } from 'node:test'
import { Board, literal, ms } from './board.mjs'

const looks = {
  next: (board) => board.nextLine(),
  level: (board, pin) => (board.run(3), board.level(Number(pin)) ? ' high' : ' low'),
  duty: (board, pin) => ` duty ${board.duty(Number(pin))}`
}

function expectFacts(board, script) {
  for (const fact of literal('differential').scripts[script]) {
    let seen = board.ask(fact.request)
    if (fact.look) {
      const [what, where] = fact.look.split(' ')
      seen += looks[what](board, where)
    }
    assert.equal(seen, fact.pico ?? fact.ours ?? fact.of_04, fact.request)
    assert.ok(fact.pico === undefined || fact.why, `${fact.request}: why is a Pico another?`)
  }
}

test('requests of the differential test: input and output', () => {
  expectFacts(new Board('asip_pico'), 'input and output')
})

test('requests of the differential test: robot', () => {
  expectFacts(new Board('asip_pico_services'), 'robot')
})

test('its banner, its name, its pins', () => {
  const board = new Board('asip_pico_services')
  assert.equal(board.banner, '!ChipServices running on RP2040 with Services: I M E B R D T O ')
  assert.equal(board.ask('#,?'), '@#,?,0,4,RP2040,30,ChipServices')
  assert.equal(
    board.ask('#,N'),
    '@#,N,8,{I:ASIP core IO,M:Motors,E:Encoders,B:Bump Sensors,R:IR Sensors,D:Distance,T:Tone,O:OneWire}'
  )
  assert.equal(board.ask('I,m'), '@I,m,4,{26:0,27:1,28:2,29:3}')
  assert.ok(board.ask('I,M').startsWith('@I,M,30,{0:1,0:2,0:4,0:8,0:10,0:20,0:40,0:80,1:1,'))
})

/** Levels, PWM, and which reports come. */
function state(board) {
  const pins = [...Array(20).keys()].slice(2)
  const levels = pins.map((pin) => board.duty(pin) ?? (board.level(pin) ? 'high' : 'low'))
  board.linesWithin(ms(1))
  const reports = new Set(board.linesWithin(ms(250)).map((line) => line.slice(0, 4)))
  return [...levels, ...[...reports].sort()].join(' ')
}

function freshBoard() {
  const board = new Board('asip_pico_services', { slowness: 4 })
  board.ask('#,R')
  board.give('#,B,57600\n')
  board.run(20)
  board.text = ''
  return board
}

test('literal bytes of published clients have the effect of whole requests', () => {
  let rows = 0
  for (const library of literal('literal_bytes').libraries) {
    if (!library.channels.includes('serial')) continue
    for (const row of library.rows) {
      const bytes = freshBoard(), whole = freshBoard()
      for (const write of row.writes) {
        bytes.give(write)
        bytes.run(30)
      }
      bytes.run(1100)
      for (const request of row.executes) {
        whole.give(request + '\n')
        whole.run(30)
      }
      whole.run(300)
      assert.equal(state(bytes), state(whole), `${library.library}, ${row.class}`)
      rows++
    }
  }
  assert.ok(rows > 20)
})
