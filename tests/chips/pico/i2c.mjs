// SPDX-License-Identifier: Apache-2.0
// The first I2C bus of a Pico, on pins 4 and 5, with what is wired to it. rp2040js takes no time for a transfer; here each bit takes ten
// microseconds. A device: {address, isThere(), started(reading), write(byte): acknowledged, read(): byte}.
export const SDA = 4, SCL = 5
const I2C = 3 // the function of a pin
const BIT_NANOS = 10e3, BYTE_NANOS = 9 * BIT_NANOS

export class I2cBus {
  devices = []
  addressed = undefined

  constructor(pico) {
    this.pico = pico
  }

  /** After each reset of the chip, which has a new controller then. */
  connect(rp2040) {
    const controller = rp2040.i2c[0]
    const after = (nanos, task) => this.pico.after(nanos, task)
    this.addressed = undefined
    controller.onStart = () => after(BIT_NANOS, () => controller.completeStart())
    controller.onStop = () => after(BIT_NANOS, () => controller.completeStop())
    controller.onConnect = (address, reading) => after(BYTE_NANOS, () => {
      this.addressed = this.isWired(rp2040) ? this.devices.find((device) => device.address === address && device.isThere()) : undefined
      this.addressed?.started(reading === 1)
      controller.completeConnect(this.addressed !== undefined)
    })
    controller.onWriteByte = (byte) => after(BYTE_NANOS, () => controller.completeWrite(this.addressed.isThere() && this.addressed.write(byte)))
    controller.onReadByte = () => after(BYTE_NANOS, () => controller.completeRead(this.addressed.isThere() ? this.addressed.read() : 0xff))
  }

  isWired(rp2040) {
    return [SDA, SCL].every((pin) => rp2040.gpio[pin].functionSelect === I2C)
  }
}
