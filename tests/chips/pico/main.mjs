// SPDX-License-Identifier: Apache-2.0
// One simulated Pico in step with real time: `node main.mjs BOARD`, where BOARD is JSON: {"image": FILE, "parts": [...]}. Its serial
// line is a TCP port of 127.0.0.1, which the event `ready` tells. Commands come as lines on standard input (`press knob`, `reset`),
// what happens leaves as lines of JSON on standard output. Ends with standard input.
import { createServer } from 'node:net'
import { createInterface } from 'node:readline'
import { Pico } from './chip.mjs'
import { ADVICE, findEmulator } from './emulator.mjs'
import { command, wire } from './parts.mjs'

const SLICE_MS = 1
const MAX_TURN_NANOS = 10e6 // then its host and its commands are heard
const MAX_LAG_NANOS = 200e6 // what a board that is further behind does not catch up with
const MAX_QUEUED_BYTES = 1024

const settings = JSON.parse(process.argv[2])
const emulator = findEmulator([process.env.ASIP_RP2040JS])
if (emulator === undefined) throw new Error(ADVICE)
const print = (object) => process.stdout.write(JSON.stringify(object) + '\n')
const pico = new Pico(emulator, settings.image)
const parts = wire(pico, settings.parts ?? [], (part, kind, value) => print({ part, kind, value }))

let line
let toHost = []
pico.onByte = (byte) => line && toHost.push(byte)

const clock = () => Number(process.hrtime.bigint())
let began = clock() - pico.now
function turn() {
  const behind = Math.min(clock() - began - pico.now, MAX_LAG_NANOS)
  began = clock() - pico.now - behind
  if (behind > 0) pico.runFor(Math.min(behind, MAX_TURN_NANOS))
  if (line && toHost.length > 0) line.write(Buffer.from(toHost))
  toHost = []
  if (line?.isPaused() && pico.uart.waiting <= MAX_QUEUED_BYTES) line.resume()
  if (behind > MAX_TURN_NANOS) setImmediate(turn)
  else setTimeout(turn, SLICE_MS)
}

createInterface({ input: process.stdin })
  .on('line', (text) => {
    const [verb, part, ...argument] = text.split(' ')
    if (verb === 'reset') pico.reset()
    else command(parts, part, verb, argument.join(' '))
  })
  .on('close', () => process.exit(0))

const server = createServer((socket) => {
  line?.destroy() // one at a time, the newest
  line = socket
  socket.setNoDelay()
  socket.on('data', (bytes) => {
    pico.uart.give(bytes)
    if (pico.uart.waiting > MAX_QUEUED_BYTES) socket.pause() // a sender waits, as it does for a slow wire
  })
  socket.on('error', () => {})
  socket.on('close', () => line === socket && (line = undefined))
})
server.listen(settings.tcp ?? 0, '127.0.0.1', () => {
  print({ event: 'ready', tcp: server.address().port })
  turn()
})
