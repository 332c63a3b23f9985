// SPDX-License-Identifier: Apache-2.0
// A Pico in the emulator for tests that speak to it line by line. All time is simulated.
import { readFileSync } from 'node:fs'
import { Pico } from './pico/chip.mjs'
import { ADVICE, findEmulator } from './pico/emulator.mjs'

const { ASIP_RP2040JS, ASIP_IMAGES } = process.env
const emulator = findEmulator([ASIP_RP2040JS])
if (emulator === undefined) throw new Error(ADVICE)

export const image = (name) => `${ASIP_IMAGES}/${name}.elf`
export const literal = (name) => JSON.parse(readFileSync(new URL(`../literal/${name}.json`, import.meta.url)))
export const ms = (milliseconds) => milliseconds * 1e6
export const us = (microseconds) => microseconds * 1e3

export class Board extends Pico {
  text = ''

  constructor(name, options) {
    super(emulator, image(name), options)
    options?.before?.(this) // wires parts, before the board starts
    this.boot()
  }

  boot() {
    this.onByte = (byte) => (this.text += String.fromCharCode(byte))
    this.banner = this.nextLine(ms(500))
    this.ask('I,A,0')
    this.text = ''
  }

  give(bytes) {
    this.uart.give(Buffer.from(bytes, 'latin1'))
  }

  /** The next line, or "(none)" after `limit` nanoseconds. */
  nextLine(limit = ms(300)) {
    const end = this.now + limit
    while (!this.text.includes('\n') && this.now < end) this.runFor(us(100))
    const length = this.text.indexOf('\n')
    if (length < 0) return '(none)'
    const line = this.text.slice(0, length)
    this.text = this.text.slice(length + 1)
    return line
  }

  /** Sends a request; all lines until a fence behind it, joined by '|', without the answer of the fence. */
  ask(line) {
    this.give(`${line}\n#,E,f\n`)
    const lines = []
    for (;;) {
      const next = this.nextLine(ms(500))
      if (next === '@#,E,f') return lines.join('|')
      if (next === '(none)') throw new Error(`no answer to ${line}: ${lines.join('|')}`)
      lines.push(next)
    }
  }

  linesWithin(nanos) {
    this.runFor(nanos)
    const lines = this.text.split('\n')
    this.text = lines.pop()
    return lines
  }

  run(milliseconds) {
    this.runFor(ms(milliseconds))
  }
}
