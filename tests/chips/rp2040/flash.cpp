// SPDX-License-Identifier: Apache-2.0
// The flash beside the chip, a W25Q16, by the serial interface that the program is read through: while that
// speaks to the flash itself, nothing may run from it. What follows is in RAM, with the interrupts off: 45 ms
// for a sector.
#include <Arduino.h>
#include <EEPROM.h>

#include "registers.h"

using namespace rp2040;

#define IN_RAM __attribute__((section(".ramcode"), noinline, long_call))

static constexpr uint32_t kSector = 0x1ff000, kReadAt = 0x10000000 + kSector;
static constexpr uint32_t kPageBytes = 256, kEnabled = kSsi + 0x08, kStatus = kSsi + 0x28,
                          kData = kSsi + 0x60;
static constexpr uint32_t kSelect = kIoQspi + 0x0c, kFlushCache = 0x14000004;
static constexpr uint8_t kWriteEnable = 0x06, kReadStatus = 0x05, kErase = 0x20, kProgram = 0x02;

EEPROMClass EEPROM;

// Selected while the output is overridden to low (2), and not while it is high (3).
static IN_RAM void select(uint32_t level) {
    at(kSelect) = level << 8;
    const uint32_t settled = at(kSelect);
    (void)settled;
}

static IN_RAM uint8_t exchange(uint8_t byte) {
    at(kData) = byte;
    while ((at(kStatus) & 1u << 3) == 0) {
    }
    return static_cast<uint8_t>(at(kData));
}

static IN_RAM void command(uint8_t code, uint32_t address, const uint8_t* bytes, uint32_t count) {
    select(2);
    exchange(kWriteEnable);
    select(3);
    select(2);
    exchange(code);
    exchange(static_cast<uint8_t>(address >> 16));
    exchange(static_cast<uint8_t>(address >> 8));
    exchange(static_cast<uint8_t>(address));
    for (uint32_t i = 0; i < count; ++i)
        exchange(bytes[i]);
    select(3);
    uint8_t status;
    do {
        select(2);
        exchange(kReadStatus);
        status = exchange(0);
        select(3);
    } while (status & 1);
}

static IN_RAM void rewrite(const uint8_t* bytes, uint32_t size) {
    const uint32_t format = at(kSsi), count = at(kSsi + 4), protocol = at(kSsi + 0xf4);
    at(kEnabled) = 0;
    at(kSsi) = 7u << 16;  // frames of eight bits, both ways
    at(kSsi + 4) = 0;
    at(kSsi + 0xf4) = 0;
    at(kEnabled) = 1;
    command(kErase, kSector, nullptr, 0);
    for (uint32_t done = 0; done < size; done += kPageBytes)
        command(kProgram, kSector + done, bytes + done, kPageBytes);
    at(kEnabled) = 0;
    at(kSsi) = format;
    at(kSsi + 4) = count;
    at(kSsi + 0xf4) = protocol;
    at(kEnabled) = 1;
    at(kSelect) = 0;
    at(kFlushCache) = 1;
}

void EEPROMClass::begin(size_t) {
    const volatile uint8_t* const stored = reinterpret_cast<const volatile uint8_t*>(kReadAt);
    for (size_t i = 0; i < kMaxSize; ++i)
        bytes_[i] = stored[i];
}

bool EEPROMClass::commit() {
    noInterrupts();
    rewrite(bytes_, sizeof bytes_);
    interrupts();
    return true;
}
