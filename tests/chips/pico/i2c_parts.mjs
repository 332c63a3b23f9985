// SPDX-License-Identifier: Apache-2.0
// Chips that can be wired to the I2C bus of a simulated Pico: as the parts of the same names in sim/parts. Registers of a byte each: the
// first byte written to a chip is the number of a register, which steps on with each byte written or read.

/** @param quantities {name: [otherwise, min, max]} @param make gets (values, pico) and gives {read(register), write(register, byte), powerOn()} */
function kindOf(address, quantities, make) {
  const range = ([, min, max]) => `a number from ${min} to ${max}`
  const isIn = ([, min, max], value) => typeof value === 'number' && value >= min && value <= max
  return {
    isOnBus: true,
    members: Object.fromEntries(Object.entries(quantities).map(([name, one]) => [name, { isGood: (value) => isIn(one, value), what: range(one) }])),
    make: (pico, settings, changed) => {
      const values = Object.fromEntries(Object.entries(quantities).map(([name, [otherwise]]) => [name, settings[name] ?? otherwise]))
      const chip = make(values, pico)
      let attached = true, number = 0, numbered = false
      pico.i2c.devices.push({
        address,
        isThere: () => attached,
        started: (reading) => reading || (numbered = false),
        write: (byte) => {
          if (numbered) chip.write(number++ & 0xff, byte)
          else number = byte
          return (numbered = true)
        },
        read: () => chip.read(number++ & 0xff)
      })
      const state = () => (attached ? Object.values(values).join() : 'detached')
      const set = (argument) => {
        const wanted = argument.split(',').map((one) => one.match(/^\s*(\w+)=(-?[\d.]+)\s*$/) ?? [one])
        for (const [text, name, value] of wanted) {
          if (name === undefined) throw new Error(`set takes NAME=VALUE,..., not "${text}"`)
          if (!Object.hasOwn(quantities, name)) throw new Error(`there is no "${name}": ${Object.keys(quantities).join(', ')}`)
          if (!isIn(quantities[name], Number(value))) throw new Error(`${name} is ${range(quantities[name])}`)
        }
        for (const [, name, value] of wanted) values[name] = Number(value)
        changed(state())
      }
      const plug = (to) => {
        attached = to
        if (attached) chip.powerOn()
        changed(state())
      }
      return { state, set, detach: () => plug(false), attach: () => plug(true) }
    }
  }
}

/** Byte 0 or 1 of a number of 16 bits, the higher first. */
const byteOf = (value, byte) => (Math.round(value) >> (byte === 0 ? 8 : 0)) & 0xff

// By the register map of the MPU-6000 and MPU-6050. It sleeps until it is woken.
const WORD = [0, -32768, 32767]
const mpu6050 = kindOf(0x68, { ax: WORD, ay: WORD, az: [16384, -32768, 32767], gx: WORD, gy: WORD, gz: WORD }, (values) => {
  const FIRST = [[0x3b, ['ax', 'ay', 'az']], [0x43, ['gx', 'gy', 'gz']]], POWER = 0x6b, ASLEEP = 0x40, WHO_AM_I = 0x75
  let power = ASLEEP
  return {
    powerOn: () => (power = ASLEEP),
    write: (number, byte) => number === POWER && (power = byte),
    read: (number) => {
      if (number === WHO_AM_I) return 0x68
      if (number === POWER) return power
      const found = FIRST.find(([first]) => number >= first && number < first + 6)
      if (found === undefined || power & ASLEEP) return 0
      const at = number - found[0]
      return byteOf(values[found[1][at >> 1]], at % 2)
    }
  }
})

// By the data sheet of the HMC5883L: a compass, which measures once it is in continuous mode.
const hmc5883l = kindOf(0x1e, { x: [100, -2048, 2047], y: [0, -2048, 2047], z: [0, -2048, 2047] }, (values) => {
  const MODE = 2, FIRST = 3, IDENTITY = 10, CONTINUOUS = 0, IDLE = 3
  let mode = IDLE
  return {
    powerOn: () => (mode = IDLE),
    write: (number, byte) => number === MODE && (mode = byte & 3),
    read: (number) => {
      if (number === MODE) return mode
      if (number >= IDENTITY && number < IDENTITY + 3) return 'H43'.charCodeAt(number - IDENTITY)
      const at = number - FIRST
      return at < 0 || at >= 6 || mode !== CONTINUOUS ? 0 : byteOf(values['xzy'[at >> 1]], at % 2)
    }
  }
})

// By the data sheet of the BMP085, whose example of calibration words this chip has.
const [AC1, AC2, AC3, AC4, AC5, AC6, B1, B2, , MC, MD] = [408, -72, -14383, 32741, 32757, 23153, 6190, 4, -32768, -8711, 2868]
const CALIBRATION = [AC1, AC2, AC3, AC4, AC5, AC6, B1, B2, -32768, MC, MD]
/** As `value >> bits` of numbers that have more than 32 bits. */
const shift = (value, bits) => Math.floor(value / 2 ** bits)
function temperatureOf(raw) {
  const x1 = shift((raw - AC6) * AC5, 15)
  const b5 = x1 + Math.trunc((MC * 2048) / (x1 + MD))
  return { b5, tenths: shift(b5 + 8, 4) }
}
function pressureOf(raw, b5, oversampling) {
  const b6 = b5 - 4000, square = shift(b6 * b6, 12)
  const b3 = Math.trunc(((AC1 * 4 + shift(B2 * square, 11) + shift(AC2 * b6, 11)) * 2 ** oversampling + 2) / 4)
  const x3 = shift(shift(AC3 * b6, 13) + shift(B1 * square, 16) + 2, 2)
  const b4 = shift(AC4 * (x3 + 32768), 15)
  const b7 = (raw - b3) * (50000 >> oversampling)
  const p = b7 < 0x80000000 ? Math.trunc((b7 * 2) / b4) : Math.trunc(b7 / b4) * 2
  return p + shift(shift(shift(p, 8) ** 2 * 3038, 16) + shift(-7357 * p, 16) + 3791, 4)
}
/** The smallest number from `low` to `high` whose measure is not below `wanted`. */
function search(low, high, wanted, measure) {
  while (low < high) {
    const middle = (low + high) >> 1
    if (measure(middle) < wanted) low = middle + 1
    else high = middle
  }
  return low
}
const bmp085 = kindOf(0x77, { pressure: [1013.25, 300, 1100], temperature: [20, -40, 85] }, (values, pico) => {
  const FIRST = 0xaa, CONTROL = 0xf4, RESULT = 0xf6, IDENTITY = 0xd0, MEASURE_TEMPERATURE = 0x2e, MEASURE_PRESSURE = 0x34
  const PRESSURE_US = [4500, 7500, 13500, 25500]
  let result = 0 // 24 bits
  let measured = 0
  const start = (next, microseconds) => {
    const mine = ++measured
    pico.after(microseconds * 1e3, () => mine === measured && (result = next))
  }
  return {
    powerOn: () => {
      measured++
      result = 0
    },
    write: (number, byte) => {
      if (number !== CONTROL) return
      const raw = search(20300, 65535, Math.round(values.temperature * 10), (one) => temperatureOf(one).tenths)
      if (byte === MEASURE_TEMPERATURE) return start(raw * 256, 4500)
      if ((byte & 0x3f) !== MEASURE_PRESSURE) return
      const oversampling = byte >> 6, { b5 } = temperatureOf(raw)
      const found = search(0, 65535 << oversampling, values.pressure * 100, (one) => pressureOf(one, b5, oversampling))
      start(found * 2 ** (8 - oversampling), PRESSURE_US[oversampling])
    },
    read: (number) => {
      if (number >= FIRST && number < FIRST + 22) return byteOf(CALIBRATION[(number - FIRST) >> 1], (number - FIRST) % 2)
      if (number < RESULT || number > RESULT + 2) return number === IDENTITY ? 0x55 : 0
      return (result >> (8 * (RESULT + 2 - number))) & 0xff
    }
  }
})

export const i2cKinds = { mpu6050, hmc5883l, bmp085 }
