// SPDX-License-Identifier: Apache-2.0
// The UART of an RP2040 (a PL011): rp2040js has one whose bytes take no time and whose queues are never full. This one takes the
// bit times that the divisor says, has two queues of 32, and loses what comes while the one is full.

const DATA = 0x00, FLAGS = 0x18, DIVISOR = 0x24, FRACTION = 0x28, FORMAT = 0x2c, CONTROL = 0x30, LEVELS = 0x34
const MASK = 0x38, RAW = 0x3c, MASKED = 0x40, CLEAR = 0x44
const BUSY = 1 << 3, NOTHING_RECEIVED = 1 << 4, SEND_FULL = 1 << 5, RECEIVE_FULL = 1 << 6, SEND_EMPTY = 1 << 7
const RECEIVED = 1 << 4, SENT = 1 << 5, TIMEOUT = 1 << 6
const OVERRUN = 1 << 11
const QUEUE = 32
const IRQ = 20

export function makeUart({ BasePeripheral }, rp2040, { sent }) {
  return new (class extends BasePeripheral {
    divisor = 0
    fraction = 0
    format = 0
    control = 0x300
    levels = 0x12
    mask = 0
    raw = 0
    sending = []
    isSending = false
    received = []
    lost = false
    coming = []
    overruns = 0
    sendAlarm = rp2040.clock.createAlarm(() => this.byteSent())
    receiveAlarm = rp2040.clock.createAlarm(() => this.byteReceived())
    timeoutAlarm = rp2040.clock.createAlarm(() => this.timedOut())

    /** Bits a second, as the divisor makes them; 0 before it is set. */
    get baud() {
      return this.divisor === 0 ? 0 : rp2040.clkPeri / (16 * (this.divisor + this.fraction / 64))
    }
    get bitNanos() {
      return 1e9 / this.baud
    }
    get waiting() {
      return this.coming.length
    }

    /** Bytes for the board; they come one behind the other, as on a wire. */
    give(bytes) {
      if (this.baud === 0) return
      const idle = this.coming.length === 0
      for (const byte of bytes) this.coming.push(byte)
      if (idle && this.coming.length > 0) this.receiveAlarm.schedule(10 * this.bitNanos)
    }

    reset() {
      for (const alarm of [this.sendAlarm, this.receiveAlarm, this.timeoutAlarm]) alarm.cancel()
      this.divisor = this.fraction = this.format = this.mask = this.raw = 0
      this.sending = []
      this.received = []
      this.coming = []
      this.isSending = this.lost = false
      this.update()
    }

    byteReceived() {
      const byte = this.coming.shift()
      if (this.received.length < QUEUE) {
        this.received.push(byte | (this.lost ? OVERRUN : 0))
        this.lost = false
      } else {
        this.lost = true
        this.overruns++
      }
      this.timeoutAlarm.schedule(32 * this.bitNanos)
      if (this.coming.length > 0) this.receiveAlarm.schedule(10 * this.bitNanos)
      this.update()
    }

    timedOut() {
      if (this.received.length === 0) return
      this.raw |= TIMEOUT
      this.update()
    }

    byteSent() {
      sent(this.onWire)
      this.isSending = false
      this.sendNext()
      if (this.sending.length === this.sendLevel) this.raw |= SENT
      this.update()
    }

    sendNext() {
      if (this.isSending || this.sending.length === 0) return
      this.onWire = this.sending.shift()
      this.isSending = true
      this.sendAlarm.schedule(10 * this.bitNanos)
    }

    get sendLevel() {
      return [4, 8, 16, 24, 28][this.levels & 7] ?? 16
    }
    get receiveLevel() {
      return [4, 8, 16, 24, 28][(this.levels >> 3) & 7] ?? 16
    }

    update() {
      if (this.received.length >= this.receiveLevel) this.raw |= RECEIVED
      else this.raw &= ~RECEIVED
      if (this.received.length === 0) this.raw &= ~TIMEOUT
      if (this.sending.length > this.sendLevel) this.raw &= ~SENT
      rp2040.setInterrupt(IRQ, (this.raw & this.mask) !== 0)
    }

    readUint32(offset) {
      switch (offset) {
        case DATA: {
          const value = this.received.shift() ?? 0
          this.update()
          return value
        }
        case FLAGS:
          return (
            (this.isSending ? BUSY : 0) |
            (this.received.length === 0 ? NOTHING_RECEIVED : 0) |
            (this.sending.length >= QUEUE ? SEND_FULL : 0) |
            (this.received.length >= QUEUE ? RECEIVE_FULL : 0) |
            (this.sending.length === 0 ? SEND_EMPTY : 0)
          )
        case DIVISOR:
          return this.divisor
        case FRACTION:
          return this.fraction
        case FORMAT:
          return this.format
        case CONTROL:
          return this.control
        case LEVELS:
          return this.levels
        case MASK:
          return this.mask
        case RAW:
          return this.raw
        case MASKED:
          return this.raw & this.mask
      }
      return super.readUint32(offset)
    }

    writeUint32(offset, value) {
      switch (offset) {
        case DATA:
          if (this.sending.length < QUEUE) this.sending.push(value & 0xff)
          this.sendNext()
          break
        case DIVISOR:
          this.divisor = value & 0xffff
          break
        case FRACTION:
          this.fraction = value & 0x3f
          break
        case FORMAT:
          this.format = value
          break
        case CONTROL:
          this.control = value
          break
        case LEVELS:
          this.levels = value
          break
        case MASK:
          this.mask = value & 0x7ff
          break
        case CLEAR:
          this.raw &= ~value
          break
        default:
          return super.writeUint32(offset, value)
      }
      this.update()
    }
  })(rp2040, 'UART0')
}
