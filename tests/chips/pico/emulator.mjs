// SPDX-License-Identifier: Apache-2.0
// Finds rp2040js, which is no part of this project: where NODE_PATH says, beside a folder of ours, or installed for all.
import { createRequire } from 'node:module'
import { dirname, join, resolve } from 'node:path'

export const VERSION = '1.4.1'
export const ADVICE = `rp2040js, the emulator of the Raspberry Pi Pico, is not installed: npm install --global rp2040js@${VERSION}`

/** The module, or undefined. `folders` have a node_modules in them. */
export function findEmulator(folders = []) {
  const usual = ['/usr/local/lib', join(dirname(process.execPath), '..', 'lib')]
  for (const folder of [...folders, ...usual]) {
    const require = createRequire(join(resolve(folder), 'any.js'))
    try {
      return require('rp2040js')
    } catch (error) {
      if (error.code !== 'MODULE_NOT_FOUND') throw error
    }
  }
  return undefined
}
