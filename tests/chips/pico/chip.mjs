// SPDX-License-Identifier: Apache-2.0
// A Raspberry Pi Pico in the emulator rp2040js, with a UART, a flash and an I2C bus of our own. Its time passes only in runFor().
import { readFileSync, writeFileSync, existsSync } from 'node:fs'
import { addFlash, FLASH_BYTES } from './flash.mjs'
import { I2cBus } from './i2c.mjs'
import { makeUart } from './uart.mjs'

const FLASH = 0x10000000, VECTORS = FLASH + 0x100
const PWM = 4
export const PINS = 30, FIRST_ANALOG_PIN = 26, CHANNELS = 4

/** The parts of an image that are loaded: [[address, bytes], ...]. Throws an Error that says what is wrong with the file. */
export function readImage(file) {
  const bytes = readFileSync(file)
  const refuse = (why) => {
    throw new Error(`${file}: ${why}`)
  }
  if (bytes.length < 52 || bytes.readUInt32BE(0) !== 0x7f454c46) refuse('not an ELF file')
  if (bytes[4] !== 1 || bytes[5] !== 1 || bytes.readUInt16LE(18) !== 40)
    refuse('an image for another chip: a Pico takes ELF files for ARM')
  const table = bytes.readUInt32LE(28), size = bytes.readUInt16LE(42), count = bytes.readUInt16LE(44)
  const pieces = []
  for (let i = 0; i < count; i++) {
    const at = table + i * size
    if (at + 32 > bytes.length) refuse('the file is cut off')
    const [type, offset, , address, length] = [0, 4, 8, 12, 16].map((place) => bytes.readUInt32LE(at + place))
    if (type !== 1 || length === 0) continue
    if (offset + length > bytes.length) refuse('the file is cut off')
    if (address < FLASH || address + length > FLASH + FLASH_BYTES) refuse('it is not linked for the flash of a Pico')
    pieces.push([address - FLASH, bytes.subarray(offset, offset + length)])
  }
  if (!pieces.some(([offset, piece]) => offset <= 0x100 && offset + piece.length >= 0x108))
    refuse('it has no vectors at 0x10000100')
  return pieces
}

export class Pico {
  /**
   * @param emulator the module rp2040js
   * @param image a file, as for readImage()
   * @param eeprom the file that keeps the last sector of the flash; none: it is erased at each start
   * @param slowness 4: a chip that needs four times as long for each instruction, and the emulator a quarter
   */
  constructor(emulator, image, { eeprom, slowness = 1 } = {}) {
    this.slowness = slowness
    this.emulator = emulator
    this.eeprom = eeprom
    this.flash = new Uint8Array(FLASH_BYTES).fill(0xff)
    this.driven = new Array(PINS).fill(null)
    this.analog = new Array(CHANNELS).fill(0)
    this.watchers = []
    this.i2c = new I2cBus(this)
    this.onByte = () => {}
    this.onReset = () => {}
    this.onFault = () => {}
    this.started = 0 // nanoseconds that passed before the last reset
    this.load(image)
  }

  /** Exchanges the firmware and restarts; what is stored stays. */
  load(image) {
    const pieces = readImage(image)
    this.flash.fill(0xff, 0, FLASH_BYTES - 4096)
    for (const [offset, bytes] of pieces) this.flash.set(bytes, offset)
    if (this.rp2040 === undefined && this.eeprom && existsSync(this.eeprom))
      this.flash.set(readFileSync(this.eeprom).subarray(0, 4096), FLASH_BYTES - 4096)
    this.powerUp()
  }

  reset() {
    this.powerUp()
    this.onReset()
  }

  powerUp() {
    if (this.rp2040) {
      this.started += this.rp2040.clock.nanos
      this.flash.set(this.rp2040.flash.subarray(0, FLASH_BYTES))
    }
    const { RP2040 } = this.emulator
    const rp2040 = (this.rp2040 = new RP2040())
    const quiet = () => {}
    rp2040.logger = { debug: quiet, info: quiet, warn: quiet, error: (_where, what) => this.onFault(what) }
    rp2040.flash.set(this.flash)
    this.uart = makeUart(this.emulator, rp2040, { sent: (byte) => this.onByte(byte) })
    rp2040.peripherals[0x40034] = this.uart
    addFlash(this.emulator, rp2040, { changed: () => this.store() })
    this.i2c.connect(rp2040)
    this.watchOutputs()
    // What the boot loader does at its end.
    rp2040.core.VTOR = VECTORS
    rp2040.core.SP = rp2040.readUint32(VECTORS)
    rp2040.core.PC = rp2040.readUint32(VECTORS + 4) & ~1
    rp2040.gpio.forEach((pin, number) => pin.addListener(() => this.settle(number)))
    this.levels = new Array(PINS).fill(false)
    this.shown = new Array(PINS).fill(-1)
    for (let channel = 0; channel < CHANNELS; channel++) rp2040.adc.channelValues[channel] = this.analog[channel]
    for (let pin = 0; pin < PINS; pin++) this.settle(pin)
  }

  // rp2040js tells of levels only, and of a new duty at the next edge.
  watchOutputs() {
    const after = (peripheral, pinsOf) => {
      const write = peripheral.writeUint32.bind(peripheral)
      peripheral.writeUint32 = (offset, value) => {
        write(offset, value)
        for (const pin of pinsOf(offset)) if (pin < PINS) this.settle(pin)
      }
    }
    after(this.rp2040.peripherals[0x40014], (offset) => (offset < 8 * PINS ? [offset >> 3] : []))
    after(this.rp2040.pwm, (offset) => {
      const slice = Math.floor(offset / 0x14)
      return slice < 8 ? [2 * slice, 2 * slice + 1, 2 * slice + 16, 2 * slice + 17] : []
    })
  }

  store() {
    if (this.eeprom) writeFileSync(this.eeprom, this.rp2040.flash.subarray(FLASH_BYTES - 4096, FLASH_BYTES))
  }

  /** Nanoseconds since it was made. */
  get now() {
    return this.started + this.rp2040.clock.nanos
  }

  runFor(nanos) {
    const { rp2040 } = this
    const { core, clock } = rp2040
    const end = clock.nanos + nanos
    while (clock.nanos < end && rp2040 === this.rp2040) {
      if (core.waiting) clock.tick(Math.min(Math.max(clock.nanosToNextAlarm, 1), end - clock.nanos))
      else clock.tick((core.executeInstruction() * 1e9 * this.slowness) / rp2040.clkSys)
    }
  }

  /** Calls `task` once, `nanos` of the board's time from now; a reset forgets it. */
  after(nanos, task) {
    this.rp2040.clock.createAlarm(task).schedule(nanos)
  }

  /** From outside: true, false, or null for a pin that nothing drives. */
  drive(pin, level) {
    this.driven[pin] = level
    this.settle(pin)
  }

  level(pin) {
    return this.levels[pin]
  }

  /** What is on the wire of a pin: what drives it, what the chip puts out, a pull-up, or low. Tells watchers of what has changed. */
  settle(pin) {
    const gpio = this.rp2040.gpio[pin]
    const level = this.driven[pin] ?? (gpio.outputEnable ? gpio.outputValue : gpio.pullupEnabled)
    if (level !== this.levels[pin]) {
      this.levels[pin] = level
      gpio.setInputValue(level)
    }
    const shown = Number(level) | (Number(gpio.outputEnable) << 1) | ((this.duty(pin) ?? 256) << 2)
    if (shown === this.shown[pin]) return
    this.shown[pin] = shown
    for (const watcher of this.watchers) watcher(pin, level)
  }

  isOutput(pin) {
    return this.rp2040.gpio[pin].outputEnable
  }

  /** 0 to 255, or null where the pin is no PWM output. */
  duty(pin) {
    if (this.rp2040.gpio[pin].functionSelect !== PWM) return null
    const { cc, top } = this.rp2040.pwm.channels[(pin >> 1) % 8]
    return Math.round((((cc >>> (16 * (pin % 2))) & 0xffff) * 255) / (top + 1))
  }

  /** 0 to 4095 on a converter. */
  setAnalog(channel, value) {
    this.analog[channel] = value
    this.rp2040.adc.channelValues[channel] = value
  }
}
