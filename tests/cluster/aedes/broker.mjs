// SPDX-License-Identifier: Apache-2.0
// broker.mjs ADDRESS PORT HOST:PORT,...: one MQTT broker that keeps everything in the Redis that these Sentinels call "asip". NODE_PATH
// has the modules.
import { createRequire } from 'node:module'
import net from 'node:net'

const [address, port, addresses] = process.argv.slice(2)
const modules = createRequire(`${process.env.NODE_PATH}/`)
const load = async (name) => {
  const loaded = await import(modules.resolve(name))
  return loaded.default ?? loaded
}

const redis = {
  name: 'asip',
  sentinels: addresses.split(',').map((sentinel) => {
    const [host, port] = sentinel.split(':')
    return { host, port: Number(port) }
  }),
  retryStrategy: () => 200,
  sentinelRetryStrategy: () => 200,
  maxRetriesPerRequest: null
}
const { Aedes } = await import(modules.resolve('aedes'))
const emitter = (await load('mqemitter-redis'))({ ...redis })
// Without a listener an error ends the process; the connection is tried again.
emitter.state.on('error', (error) => console.error(`redis: ${error.message}`))
const persistence = (await load('aedes-persistence-redis'))({ ...redis, packetTTL: () => 60 })
const broker = await Aedes.createBroker({
  id: `node${port}`,
  mq: emitter,
  persistence,
  concurrency: 1000,
  heartbeatInterval: 5000
})
// Its check for duplicates drops acknowledged messages on connections that also receive QoS 0.
broker.on('client', (client) => {
  client.duplicates = new Proxy({}, { get: () => 0, set: () => true, deleteProperty: () => true })
})
broker.on('clientError', (client, error) => console.error(`${client.id}: ${error.message}`))
broker.on('connectionError', (client, error) => console.error(error.message))
net.createServer({ noDelay: true }, broker.handle).listen(Number(port), address, () => console.error(`listening on ${port}`))
