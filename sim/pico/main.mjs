// SPDX-License-Identifier: Apache-2.0
// One simulated Pico in step with real time: `node main.mjs BOARD`, where BOARD is JSON: {"name", "image": FILE, "eeprom": FILE,
// "frequency": HERTZ, "parts": [...], "tcp": PORT, "line": FD}. Its serial line is a TCP port of 127.0.0.1 (0: any), or a socket
// that the parent passed. Commands come as lines of JSON on standard input ({"id", "verb", "part", "argument"}), answers ({"id",
// "text" or "error"}) and events leave on standard output. Ends with standard input. asip-sim starts it.
import { createServer, Socket } from 'node:net'
import { createInterface } from 'node:readline'
import { Pico } from './chip.mjs'
import { ADVICE, findEmulator } from './emulator.mjs'
import { command, wire } from './parts.mjs'

const SLICE_NANOS = 1e6
const MAX_TURN_NANOS = 10e6 // then its host and its commands are heard
const MAX_LAG_NANOS = 200e6 // what a board that is further behind does not catch up with
const MAX_QUEUED_BYTES = 1024
const MAX_UNREAD_BYTES = 64 * 1024
const MAX_FAULTS = 10
const BAD_BOARD = 2, NO_EMULATOR = 3

function end(status, text) {
  process.stderr.write(text + '\n')
  process.exit(status)
}

const settings = JSON.parse(process.argv[2])
const emulator = findEmulator(settings.modules ? [settings.modules] : [])
if (emulator === undefined) end(NO_EMULATOR, ADVICE)

const print = (object) => process.stdout.write(JSON.stringify(object) + '\n')
const seconds = () => Math.round(pico.now / 1000) / 1e6
const event = (name, details = {}) => print({ event: name, time: seconds(), ...details })

let pico, parts
try {
  pico = new Pico(emulator, settings.image, { eeprom: settings.eeprom, slowness: 12e6 / (settings.frequency ?? 12e6) })
  parts = wire(pico, settings.parts ?? [], (part, kind, value) => print({ part, kind, value, time: seconds() }))
} catch (error) {
  end(BAD_BOARD, error.message)
}

// The line.
let line
function use(socket) {
  if (line) return socket.destroy() // one at a time
  line = socket
  socket.setNoDelay?.(true)
  socket.on('data', (bytes) => {
    // They take their time on the wire from now on, not from when the board last ran.
    const behind = clock() - began - pico.now
    if (plugged && behind > 0) pico.runFor(Math.min(behind, MAX_TURN_NANOS))
    pico.uart.give(bytes)
    if (pico.uart.waiting > MAX_QUEUED_BYTES) socket.pause() // a sender waits, as it does for a slow wire
    wake()
  })
  socket.on('error', () => {})
  socket.on('close', () => {
    if (line === socket) line = undefined
  })
}
let toHost = []
pico.onByte = (byte) => line && toHost.push(byte)
let faults = 0 // told of the first ones: a program in a loop makes the same one for ever
pico.onFault = (what) => faults++ < MAX_FAULTS && event('fault', { what })
pico.onReset = () => event('reset', { cause: 'external' })
function sendToHost() {
  if (line && toHost.length > 0 && line.writableLength < MAX_UNREAD_BYTES) line.write(Buffer.from(toHost))
  toHost = []
  if (line?.isPaused() && pico.uart.waiting <= MAX_QUEUED_BYTES) line.resume()
}

// Time: the board runs up to the clock, and is never far ahead of it.
const clock = () => Number(process.hrtime.bigint())
let began = clock() - pico.now
let skipped = 0, reportedOverruns = 0, plugged = true, timer
function turn() {
  let behind = clock() - began - pico.now
  if (behind > MAX_LAG_NANOS) {
    skipped += behind - MAX_LAG_NANOS
    began += behind - MAX_LAG_NANOS
    behind = MAX_LAG_NANOS
  }
  if (plugged && behind > 0) pico.runFor(Math.min(behind, MAX_TURN_NANOS))
  sendToHost()
  timer = undefined
  if (plugged && behind > MAX_TURN_NANOS) setImmediate(turn)
  else wait()
}
function wait() {
  timer ??= setTimeout(turn, SLICE_NANOS / 1e6)
}
function wake() {
  if (timer === undefined) return
  clearTimeout(timer)
  timer = undefined
  setImmediate(turn)
}
setInterval(() => {
  if (skipped >= 1e6) event('behind', { milliseconds: Math.round(skipped / 1e6) })
  skipped = 0
  if (pico.uart.overruns > reportedOverruns)
    event('overrun', { bytes: pico.uart.overruns - reportedOverruns, direction: 'to-board' })
  reportedOverruns = pico.uart.overruns
}, 1000)

const boardCommands = {
  list: () => [...parts].map(([name, { kind, state }]) => `${settings.name ? settings.name + '/' : ''}${name} ${kind} ${state()}\n`).join(''),
  reset: () => void pico.reset(),
  load: (image) => {
    pico.load(image)
    event('loaded', { image })
  },
  unplug: () => void (plugged = false),
  replug: () => {
    pico.reset()
    plugged = true
    began = clock() - pico.now
    wake()
  }
}

createInterface({ input: process.stdin })
  .on('line', (text) => {
    const { id, verb, part, argument } = JSON.parse(text)
    try {
      const answer = part ? command(parts, part, verb, argument) : boardCommands[verb](argument)
      print({ id, text: answer ?? '', ...(verb === 'list' && { parts: [...parts.keys()] }) })
    } catch (error) {
      print({ id, error: error.message })
    }
    wake()
  })
  .on('close', () => process.exit(0))

if (settings.line !== undefined) use(new Socket({ fd: settings.line, readable: true, writable: true }))
if (settings.tcp === undefined) {
  event('ready', { parts: [...parts.keys()] })
  turn()
} else {
  const server = createServer(use)
  server.on('error', (error) => end(BAD_BOARD, `port ${settings.tcp}: ${error.message}`))
  server.listen(settings.tcp, '127.0.0.1', () => {
    event('ready', { parts: [...parts.keys()], tcp: server.address().port })
    turn()
  })
}
