// SPDX-License-Identifier: Apache-2.0
// Services on the I2C bus of a Pico, by the Wire of its core, with simulated chips at the other end.
import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { test } from 'node:test'
import { command, wire } from './pico/parts.mjs'
import { Board, ms } from './board.mjs'

const CHIPS = [
  { kind: 'mpu6050', name: 'motion', ax: 12, ay: -340, az: 16384, gx: 1, gy: -32768, gz: 32767 },
  { kind: 'hmc5883l', name: 'compass', x: 100, y: -20, z: 30 },
  { kind: 'bmp085', name: 'barometer', pressure: 699.64, temperature: 15 }
]

class I2cBoard extends Board {
  constructor(chips = CHIPS, display = undefined) {
    super('asip_pico_i2c', { before: (pico) => {
      pico.parts = wire(pico, chips, () => {})
      if (display) pico.i2c.devices.push(display)
    } })
    this.run(20) // the chips were found
  }

  measure(request) {
    return this.ask(request) || this.nextLine(ms(200))
  }

  command(part, verb, argument) {
    command(this.parts, part, verb, argument)
  }
}

test('they own the bus, and nobody else gets its pins', () => {
  const pico = new I2cBoard()
  assert.equal(pico.ask('#,N'), '@#,N,6,{I:ASIP core IO,A:Accelerometer,G:Gyro,H:Heading,P:Pressure,L:LCD}')
  for (const request of ['I,P,4,3', 'I,P,5,4']) assert.equal(pico.ask(request), '~I,P,9{I2C_NOT_ENABLED}')
  assert.equal(pico.ask('I,d,4,1'), '~I,d,9{I2C_NOT_ENABLED}')
  assert.equal(pico.ask('I,P,6,3'), '')
  assert.equal(pico.measure('A,M'), '@A,e,3,{12,-340,16384}', 'the bus was not disturbed')
})

test('measurements are what the chips measure', () => {
  const pico = new I2cBoard()
  assert.equal(pico.measure('A,M'), '@A,e,3,{12,-340,16384}')
  assert.equal(pico.measure('G,M'), '@G,e,3,{1,-32768,32767}')
  assert.equal(pico.measure('H,M'), '@H,e,4,{100,-20,30,348}')
  // The example of the chip's data sheet.
  assert.ok(pico.measure('P,M').startsWith('@P,e,3,{699.64,15.00,'))
  pico.command('motion', 'set', 'ax=-1,gz=5')
  assert.equal(pico.measure('A,M'), '@A,e,3,{-1,-340,16384}')
  assert.equal(pico.measure('G,M'), '@G,e,3,{1,-32768,5}')
  for (const pressure of [1013.25, 900, 310]) {
    for (const temperature of [-20, 24.3, 60]) {
      pico.command('barometer', 'set', `pressure=${pressure},temperature=${temperature}`)
      const [, hectopascals, degrees, metres] = pico.measure('P,M').match(/^@P,e,3,\{([\d.-]+),([\d.-]+),([\d.-]+)\}$/).map(Number)
      assert.ok(Math.abs(hectopascals - pressure) < 0.15, `${hectopascals} hPa, not ${pressure}`)
      assert.ok(Math.abs(degrees - temperature) < 0.11, `${degrees} degrees, not ${temperature}`)
      assert.ok(Math.abs(metres - 44330 * (1 - (hectopascals / 1013.25) ** 0.190295)) < 0.05, `${metres} m`)
    }
  }
})

test('reports come at their period from all four, and the line loses nothing', () => {
  const pico = new I2cBoard()
  for (const request of ['A,A,50', 'G,A,50', 'H,A,50', 'P,A,100']) assert.equal(pico.ask(request), '')
  const count = {}
  for (const line of pico.linesWithin(ms(1000))) count[line[1]] = (count[line[1]] ?? 0) + 1
  for (const service of 'AGH') assert.ok(Math.abs(count[service] - 20) <= 1, `${service}: ${count[service]}`)
  assert.ok(Math.abs(count.P - 10) <= 1, `P: ${count.P}`)
  for (const request of ['A,A,0', 'G,A,0', 'H,A,0', 'P,A,0']) pico.ask(request)
  assert.equal(pico.uart.overruns, 0)
})

test('a chip that is missing is an error, and the others work', () => {
  const pico = new I2cBoard([{ kind: 'hmc5883l', name: 'compass' }])
  for (const service of 'AGP') {
    assert.equal(pico.ask(`${service},M`), `~${service},M,8{DEVICE_NOT_AVAILABLE}`)
    assert.equal(pico.ask(`${service},A,50`), `~${service},A,8{DEVICE_NOT_AVAILABLE}`)
  }
  assert.match(pico.measure('H,M'), /^@H,e,4,\{100,0,0,/)
  assert.deepEqual(pico.linesWithin(ms(200)), [])
})

test('a chip that comes back is found, and reports go on', () => {
  const pico = new I2cBoard()
  pico.ask('A,A,20')
  assert.equal(pico.nextLine(), '@A,e,3,{12,-340,16384}')
  pico.command('motion', 'detach')
  pico.linesWithin(ms(50))
  assert.deepEqual(pico.linesWithin(ms(100)), [])
  assert.equal(pico.ask('A,M'), '~A,M,8{DEVICE_NOT_AVAILABLE}')
  pico.command('motion', 'attach')
  assert.equal(pico.nextLine(ms(50)), '@A,e,3,{12,-340,16384}')
})

test('a restart of the board, and one of the chip, find the bus again', () => {
  const pico = new I2cBoard()
  pico.give('#,R\n')
  pico.linesWithin(ms(50))
  assert.equal(pico.measure('A,M'), '@A,e,3,{12,-340,16384}')
  pico.reset()
  pico.linesWithin(ms(100))
  pico.ask('I,A,0')
  assert.equal(pico.measure('G,M'), '@G,e,3,{1,-32768,32767}')
})

test('a bus that is held low is an error, and works again when it is free', () => {
  const pico = new I2cBoard()
  pico.drive(4, false)
  command(pico.parts, 'motion', 'detach')
  assert.equal(pico.measure('A,M'), '~A,e,8{DEVICE_NOT_AVAILABLE}')
  pico.drive(4, null)
  command(pico.parts, 'motion', 'attach')
  pico.ask('A,M')
  pico.run(20)
  assert.equal(pico.measure('A,M'), '@A,e,3,{12,-340,16384}')
})

/** The memory of a display with an SH1106: 8 pages of 132 columns, of which the glass shows 128 from the third on. */
function makeDisplay() {
  const memory = Array.from({ length: 8 }, () => new Uint8Array(132))
  let control = true, isData = false, page = 0, column = 0, argument = false
  const withArgument = [0x81, 0xa8, 0xad, 0xd3, 0xd5, 0xd9, 0xda, 0xdb]
  const display = { address: 0x3c, memory, isOn: false, isThere: () => true, started: (reading) => reading || (control = true), read: () => 0 }
  display.write = (byte) => {
    if (control) isData = byte === 0x40
    else if (isData) memory[page][column++] = byte
    else if (argument) argument = false
    else if (byte <= 0x0f) column = (column & 0xf0) | byte
    else if (byte <= 0x1f) column = (column & 0x0f) | ((byte & 0x0f) << 4)
    else if ((byte & 0xf8) === 0xb0) page = byte & 7
    else if (byte >= 0xae && byte <= 0xaf) display.isOn = byte === 0xaf
    else argument = withArgument.includes(byte)
    control = false
    return true
  }
  return display
}
const font = [...readFileSync(new URL('../../firmware/src/asip/parts/Font.h', import.meta.url), 'utf8').matchAll(/\{(0x\w\w(?:, 0x\w\w){4})\}/g)].map(
  ([, columns]) => columns.split(', ').map(Number))
const columnsOf = (text) => [...text].flatMap((character) => [...font[character.charCodeAt(0) - 32], 0])

test('a display shows the lines that it is sent', () => {
  const display = makeDisplay()
  const pico = new I2cBoard([], display)
  pico.run(300)
  assert.ok(display.isOn)
  assert.ok(display.memory.every((page) => page.every((column) => column === 0)))
  assert.equal(pico.ask('L,W,0,Hello, Pico'), '')
  pico.run(100)
  const shown = columnsOf('Hello, Pico')
  assert.deepEqual([...display.memory[0].subarray(2, 2 + shown.length)], shown)
  assert.equal(pico.ask('L,W,9,x'), '~L,W,7{INVALID_DEVICE_NUMBER}')
  assert.equal(pico.ask('L,C'), '')
  pico.run(300)
  assert.ok(display.memory.every((page) => page.every((column) => column === 0)))
})

test('board files: what is wrong with a chip is said', () => {
  const refused = (parts, why) => assert.throws(() => new I2cBoard(parts), { message: why })
  refused([{ kind: 'mpu6050', ax: 40000 }], '/parts/0/ax: a number from -32768 to 32767')
  refused([{ kind: 'bmp085', pin: 4 }], '/parts/0/pin: a bmp085 has no such member')
  refused([{ kind: 'bmp085' }, { kind: 'bmp085' }], '/parts/1/kind: the bus has a bmp085 already')
  refused([{ kind: 'bmp085' }, { kind: 'led', pin: 5 }], '/parts/1/pin: the I2C bus has this pin')
  refused([{ kind: 'led', pin: 5 }, { kind: 'bmp085' }], '/parts/1/kind: the I2C bus takes pins 4 and 5, where a part is')
  const pico = new I2cBoard()
  assert.throws(() => command(pico.parts, 'motion', 'set', 'ax=1e9'), /NAME=VALUE/)
  assert.throws(() => command(pico.parts, 'motion', 'set', 'ax=99999'), /ax is a number from -32768 to 32767/)
  assert.throws(() => command(pico.parts, 'motion', 'set', 'q=1'), /there is no "q"/)
})
