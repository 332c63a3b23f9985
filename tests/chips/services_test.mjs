// SPDX-License-Identifier: Apache-2.0
// Services that need no hardware of an AVR, on a Pico: what is on its pins is what the requests say.
import assert from 'node:assert/strict'
import { test } from 'node:test'
import { Board, ms, us } from './board.mjs'

const board = () => new Board('asip_pico_services')

test('inputs: levels, pull-ups, ports of eight', () => {
  const pico = new Board('asip_pico')
  pico.drive(17, true)
  assert.equal(pico.nextLine(), '@I,d,2,2')
  assert.equal(pico.ask('I,P,18,2'), '@I,d,2,6')
  pico.drive(18, false)
  assert.equal(pico.nextLine(), '@I,d,2,2')
  pico.drive(17, false)
  assert.equal(pico.nextLine(), '@I,d,2,0')
})

test('each pin is an output, a PWM output and an input again', () => {
  const pico = new Board('asip_pico')
  for (let pin = 2; pin < 30; pin++) {
    assert.equal(pico.ask(`I,P,${pin},3`), '')
    assert.equal(pico.ask(`I,d,${pin},1`), '')
    assert.equal(pico.level(pin), true, `pin ${pin}`)
    assert.equal(pico.ask(`I,a,${pin},77`), '')
    assert.equal(pico.duty(pin), 77)
    assert.equal(pico.ask(`I,P,${pin},1`), `@I,d,${pin >> 3},0`)
    assert.equal(pico.isOutput(pin), false)
    assert.equal(pico.duty(pin), null)
  }
  for (const pin of [0, 1]) assert.equal(pico.ask(`I,P,${pin},3`), '~I,P,4{MODE_UNAVAILABLE}', 'the line has it')
  assert.equal(pico.ask('I,P,30,3'), '~I,P,3{INVALID_PIN}')
})

test('analog values: twelve bits of the converter are the ten of the model', () => {
  const pico = new Board('asip_pico')
  for (const [channel, value] of [0, 4095, 2048, 7].entries()) pico.setAnalog(channel, value)
  pico.ask('I,A,20')
  assert.equal(pico.nextLine(), '@I,a,4,{0:0,1:1023,2:512,3:1}')
})

test('reflectance: emitters on, ten bits, emitters off', () => {
  const pico = board()
  pico.setAnalog(0, 4095)
  pico.setAnalog(1, 400)
  const lit = []
  pico.watchers.push((pin, level) => pin === 14 && lit.push(level))
  pico.ask('R,A,30')
  assert.equal(pico.nextLine(), '@R,e,3,{1023,100,0}')
  assert.deepEqual(lit.slice(-2), [true, false])
})

test('motors: directions and power; stop', () => {
  const pico = board()
  assert.equal(pico.ask('M,M,100,-300'), '')
  assert.deepEqual([pico.level(8), pico.level(11), pico.duty(5)], [true, false, 100])
  assert.deepEqual([pico.level(12), pico.level(13), pico.duty(6)], [false, true, 255])
  assert.equal(pico.ask('M,S'), '')
  assert.deepEqual([pico.duty(5), pico.duty(6)], [0, 0])
})

test('bump sensors: pressed is 0', () => {
  const pico = board()
  pico.drive(10, false)
  pico.ask('B,A,20')
  assert.equal(pico.nextLine(), '@B,e,2,{1,0}')
})

/** Turns the wheel on two pins by cycles of `period` microseconds: the first pin leads. */
function turn(pico, [first, second], cycles, period) {
  const steps = [[first, true], [second, true], [first, false], [second, false]]
  let left = 4 * cycles
  const next = () => {
    if (left === 0) return
    const [pin, level] = steps[(4 * cycles - left) % 4]
    left--
    pico.drive(pin, level)
    pico.after(us(period / 4), next)
  }
  for (const pin of [first, second]) pico.drive(pin, false)
  pico.run(5)
  next()
  pico.runFor(us(cycles * period))
}

test('encoders: each edge is counted by an interrupt, whatever the board is doing', () => {
  const pico = board()
  for (const pin of [2, 3, 4, 7]) pico.drive(pin, false)
  pico.ask('E,A,20')
  pico.nextLine() // and with it what driving the pins counted
  pico.ask('E,A,500')
  pico.give('I,M\n'.repeat(10))
  turn(pico, [3, 7], 500, 600)
  const line = pico.linesWithin(ms(700)).filter((text) => text.startsWith('@E,e'))[0]
  const [, pulse, steps, , other] = line.match(/^@E,e,2,\{(\d+):(-?\d+),(\d+):(-?\d+)\}$/)
  assert.equal(Math.abs(steps), 1000)
  assert.ok(Math.abs(pulse - 300) < 15, `pulse ${pulse}`)
  assert.equal(Number(other), 0)
})

test('distance: an echo is timed by an interrupt; none is 0', () => {
  const pico = board()
  const sensors = new Map([[19, 42], [20, 250]])
  const last = new Map()
  // Triggered by a pulse of the board; answers 450 us later, when the board listens.
  pico.watchers.push((pin, level) => {
    if (!sensors.has(pin) || pico.driven[pin] !== null) return
    const triggered = last.get(pin) === true && !level
    last.set(pin, level)
    if (!triggered) return
    const echo = sensors.get(pin)
    if (echo === null) return
    pico.after(us(450), () => pico.drive(pin, true))
    pico.after(us(450 + 58.31 * echo), () => pico.drive(pin, null))
  })
  pico.give('D,M\n')
  assert.equal(pico.nextLine(), '@D,e,2,{42,250}')
  sensors.set(20, null)
  pico.give('D,M\n')
  assert.equal(pico.nextLine(), '@D,e,2,{42,0}')
})

test('tone: its wave, its length, silence', () => {
  const pico = board()
  let edges = 0
  let before = pico.level(15)
  pico.watchers.push((pin, level) => {
    if (pin === 15 && level !== before) edges++
    if (pin === 15) before = level
  })
  pico.ask('T,P,1000,100')
  pico.run(200)
  assert.ok(Math.abs(edges - 200) <= 2, `${edges} edges`)
  assert.equal(pico.level(15), false)
})

/** A 1-Wire bus with its resistor on a pin, and a device that does nothing but say that it is there. */
function wireOn(pico, pin) {
  const bus = { there: true, lows: [] }
  let held = false, low = false, since = 0
  const settle = () => pico.drive(pin, !low && !held)
  pico.rp2040.gpio[pin].addListener(() => {
    const gpio = pico.rp2040.gpio[pin]
    const now = gpio.outputEnable && !gpio.outputValue
    if (now === low) return
    low = now
    settle()
    if (low) {
      since = pico.now
      return
    }
    bus.lows.push(pico.now - since)
    if (!bus.there || pico.now - since < us(480)) return
    for (const [time, pulls] of [[30, true], [150, false]])
      pico.after(us(time), () => {
        held = pulls
        settle()
      })
  })
  settle()
  return bus
}

test('1-Wire: a device is found and read, and after a restart as before', () => {
  const pico = board()
  const wire = wireOn(pico, 21)
  for (let round = 0; round < 2; round++) {
    pico.give('O,R\n')
    assert.equal(pico.nextLine(), '@O,R,1')
    pico.give('O,T,2,CC\n')
    assert.equal(pico.nextLine(), '@O,T,FFFF')
    wire.there = false
    pico.give('O,R\n')
    assert.equal(pico.nextLine(), '@O,R,0')
    wire.there = true
    // In the midst of the low of a reset, the longest time that the board holds the line.
    pico.give('O,R\n#,R\n')
    pico.run(20)
    pico.text = ''
  }
  assert.ok(Math.max(...wire.lows) < us(600))
})
