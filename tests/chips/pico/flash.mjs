// SPDX-License-Identifier: Apache-2.0
// The flash beside an RP2040, a W25Q16 on its serial interface: write enable, status, erase of a sector, program of a page.
// rp2040js has its content, but no commands. Erasing and programming take their usual time, and programming clears bits only.

const FORMAT = 0x00, COUNT = 0x04, ENABLED = 0x08, STATUS = 0x28, DATA = 0x60, PROTOCOL = 0xf4
const WRITE_ENABLE = 0x06, READ_STATUS = 0x05, ERASE_SECTOR = 0x20, PROGRAM_PAGE = 0x02
const ERASE_NANOS = 45e6, PROGRAM_NANOS = 0.4e6
const SECTOR = 4096, PAGE = 256
export const FLASH_BYTES = 2 * 1024 * 1024

export function addFlash({ BasePeripheral }, rp2040, { changed }) {
  let selected = false, writable = false, command = [], busyUntil = 0

  const address = () => ((command[1] << 16) | (command[2] << 8) | command[3]) & (FLASH_BYTES - 1)
  const busy = () => rp2040.clock.nanos < busyUntil

  const exchange = (byte) => {
    if (!selected) return 0
    command.push(byte)
    if (command[0] === READ_STATUS && command.length > 1) return (busy() ? 1 : 0) | (writable ? 2 : 0)
    return 0
  }

  // A command is carried out when the chip is deselected.
  const finish = () => {
    const [code] = command
    if (code === WRITE_ENABLE && !busy()) writable = true
    if (writable && !busy() && code === ERASE_SECTOR && command.length === 4) {
      const start = address() & ~(SECTOR - 1)
      rp2040.flash.fill(0xff, start, start + SECTOR)
      done(ERASE_NANOS)
    } else if (writable && !busy() && code === PROGRAM_PAGE && command.length > 4) {
      const start = address() & ~(PAGE - 1)
      for (const [i, byte] of command.slice(4).entries())
        rp2040.flash[start + ((address() + i) & (PAGE - 1))] &= byte
      done(PROGRAM_NANOS)
    }
  }
  const done = (nanos) => {
    writable = false
    busyUntil = rp2040.clock.nanos + nanos
    changed()
  }

  class Interface extends BasePeripheral {
    registers = new Map()
    answers = []
    readUint32(offset) {
      if (offset === DATA) return this.answers.shift() ?? 0
      if (offset === STATUS) return 2 | 4 | (this.answers.length > 0 ? 8 : 0)
      return this.registers.get(offset) ?? 0
    }
    writeUint32(offset, value) {
      if (offset === DATA) this.answers.push(exchange(value & 0xff))
      else if ([FORMAT, COUNT, ENABLED, PROTOCOL].includes(offset)) this.registers.set(offset, value)
      if (offset === ENABLED) this.answers = []
    }
  }

  // The select line: of the interface, or overridden to low (2) or high (3).
  class Pins extends BasePeripheral {
    control = 0
    readUint32() {
      return this.control
    }
    writeUint32(offset, value) {
      if (offset !== 0x0c) return
      this.control = value
      const now = ((value >> 8) & 3) === 2
      if (selected && !now) finish()
      if (now !== selected) command = []
      selected = now
    }
  }

  class Cache extends BasePeripheral {
    readUint32() {
      return 0
    }
    writeUint32() {}
  }

  rp2040.peripherals[0x18000] = new Interface(rp2040, 'SSI')
  rp2040.peripherals[0x40018] = new Pins(rp2040, 'IO_QSPI')
  rp2040.peripherals[0x14000] = new Cache(rp2040, 'XIP_CTRL')
}
