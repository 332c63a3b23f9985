// SPDX-License-Identifier: Apache-2.0
// What can be wired to a simulated Pico: as the parts of the same names in sim/parts, for what a bench needs.
import { CHANNELS, FIRST_ANALOG_PIN, PINS } from './chip.mjs'
import { SCL, SDA } from './i2c.mjs'
import { i2cKinds } from './i2c_parts.mjs'

const flag = { isGood: (value) => typeof value === 'boolean', what: 'true or false' }
const share = { isGood: (value) => value >= 0 && value <= 1, what: 'a number from 0 to 1' }

// When the contact of a button is the other way round for a moment, and when it is back, after it closed or opened.
const BOUNCES_US = [400, 900, 2000, 3100]

/** Members, verbs and behaviour of each kind. A part shows its state by `changed(text)`. */
const kinds = {
  ...i2cKinds,
  led: {
    members: { active_low: flag },
    make: (pico, { pin, active_low: low }, changed) => {
      const state = () => {
        const duty = pico.duty(pin)
        if (duty !== null && duty > 0 && duty < 255) return `pwm ${low ? 255 - duty : duty}`
        return (pico.isOutput(pin) && pico.level(pin)) !== (low ?? false) ? 'on' : 'off'
      }
      pico.watchers.push((which) => which === pin && changed(state()))
      return { state }
    }
  },
  button: {
    members: { to_vcc: flag, steady: flag },
    make: (pico, { pin, to_vcc: high, steady }, changed) => {
      let pressed = false
      let presses = 0
      const apply = (closed) => pico.drive(pin, closed ? (high ?? false) : high ? false : null)
      apply(pressed)
      const set = (to) => {
        if (to === pressed) return
        pressed = to
        apply(pressed)
        const press = ++presses
        const bounce = (apart) => press === presses && apply(pressed !== apart)
        if (!steady) BOUNCES_US.forEach((us, index) => pico.after(us * 1000, () => bounce(index % 2 === 0)))
        changed(state())
      }
      const state = () => (pressed ? 'pressed' : 'released')
      return { state, press: () => set(true), release: () => set(false) }
    }
  },
  potentiometer: {
    members: { position: share },
    make: (pico, { pin, position = 0.5 }, changed) => {
      const set = (to) => {
        position = to
        pico.setAnalog(pin - FIRST_ANALOG_PIN, Math.round(position * 4095))
      }
      set(position)
      return {
        state: () => String(position),
        set: (argument) => {
          const to = Number(argument)
          if (argument === '' || !(to >= 0 && to <= 1)) throw new Error(`set takes a number from 0 to 1, not "${argument}"`)
          set(to)
          changed(String(to))
        }
      }
    }
  }
}

function pinOf(value) {
  const analog = typeof value === 'string' && /^[Aa]\d+$/.test(value)
  const number = analog ? FIRST_ANALOG_PIN + Number(value.slice(1)) : value
  const end = analog ? FIRST_ANALOG_PIN + CHANNELS : PINS
  if (!Number.isInteger(number) || number < 0 || number >= end)
    throw new Error(`there is no pin ${value} on the pico (0 to ${PINS - 1}, A0 to A${CHANNELS - 1})`)
  return number
}

const BUS = 'bus'

function pinFor(kind, value, taken, refuse) {
  let pin
  try {
    pin = pinOf(value)
  } catch (error) {
    refuse(error.message)
  }
  if (kind === 'potentiometer' && pin < FIRST_ANALOG_PIN) refuse('not an analog input')
  if (pin < 2) refuse('the serial line has this pin')
  if (taken.has(pin)) refuse(taken.get(pin) === BUS ? 'the I2C bus has this pin' : 'has a part already')
  return pin
}

/** The parts of a board file. Throws an Error whose text begins with the place: "/parts/1/pin: ...". */
export function wire(pico, configured, changed) {
  const parts = new Map(), taken = new Map(), busKinds = new Set()
  for (const [i, { kind, name, ...settings }] of configured.entries()) {
    const refuse = (member, why) => {
      throw new Error(`/parts/${i}/${member}: ${why}`)
    }
    if (!(kind in kinds)) refuse('kind', `a Pico has no "${kind}"; one of ${Object.keys(kinds).join(', ')}`)
    const { members, make, isOnBus } = kinds[kind]
    if (!isOnBus && !('pin' in settings)) refuse('pin', 'is missing')
    for (const [member, value] of Object.entries(settings)) {
      if (member === 'pin' && !isOnBus) continue
      if (!Object.hasOwn(members, member)) refuse(member, `a ${kind} has no such member`)
      if (!members[member].isGood(value)) refuse(member, members[member].what)
    }
    if (isOnBus) {
      if (busKinds.has(kind)) refuse('kind', `the bus has a ${kind} already`)
      if (![SDA, SCL].every((pin) => !taken.has(pin) || taken.get(pin) === BUS)) refuse('kind', `the I2C bus takes pins ${SDA} and ${SCL}, where a part is`)
      busKinds.add(kind)
      for (const pin of [SDA, SCL]) taken.set(pin, BUS)
    } else {
      settings.pin = pinFor(kind, settings.pin, taken, (why) => refuse('pin', why))
      taken.set(settings.pin, kind)
    }
    const called = name ?? `${kind}${settings.pin ?? ''}`
    if (parts.has(called)) refuse('name', `another part is called ${called}`)
    let shown
    const part = make(pico, settings, (state) => {
      if (state === shown) return
      shown = state
      changed(called, kind, state)
    })
    shown = part.state()
    parts.set(called, { kind, ...part })
  }
  return parts
}

/** Carries a command out. Throws an Error that says what is wrong. */
export function command(parts, name, verb, argument = '') {
  const part = parts.get(name)
  if (part === undefined) throw new Error(`there is no part ${name}`)
  const verbs = Object.keys(part).filter((key) => key !== 'kind' && key !== 'state')
  if (!verbs.includes(verb))
    throw new Error(`a ${part.kind} cannot ${verb}${verbs.length > 0 ? `, but ${verbs.join(', ')}` : ''}`)
  if (verb !== 'set' && argument !== '') throw new Error(`${verb} takes nothing behind the part`)
  part[verb](argument)
}
