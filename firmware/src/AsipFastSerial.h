// SPDX-License-Identifier: Apache-2.0
// Carries the line with a lean driver of its own on the chip's first UART (the second of a 32u4): 500,000
// baud with time to spare, 1,000,000 for what fits its rings. Include it in the sketch, once, instead of
// <AsipSerial.h>; the sketch must then not use `Serial`, whose interrupts it takes.
#pragma once

#ifndef __AVR__
#error "AsipFastSerial.h drives the UART of an AVR: include AsipSerial.h on this chip"
#endif

#include <Arduino.h>
#include <avr/interrupt.h>
#include <avr/io.h>

#include "asip/Config.h"
#include "asip/Hardware.h"
#include "asip/Line.h"
#include "asip/Rates.h"

#if defined(UDR0)
#define ASIP_UART(name) name##0
#if defined(USART_RX_vect)
#define ASIP_RX_VECTOR USART_RX_vect
#define ASIP_UDRE_VECTOR USART_UDRE_vect
#else
#define ASIP_RX_VECTOR USART0_RX_vect
#define ASIP_UDRE_VECTOR USART0_UDRE_vect
#endif
#define ASIP_UCSRA UCSR0A
#define ASIP_UCSRB UCSR0B
#define ASIP_UCSRC UCSR0C
#define ASIP_UBRR UBRR0
#define ASIP_UDR UDR0
#else
#define ASIP_RX_VECTOR USART1_RX_vect
#define ASIP_UDRE_VECTOR USART1_UDRE_vect
#define ASIP_UCSRA UCSR1A
#define ASIP_UCSRB UCSR1B
#define ASIP_UCSRC UCSR1C
#define ASIP_UBRR UBRR1
#define ASIP_UDR UDR1
#endif

namespace asip {
namespace line {

// Powers of two: an index is wrapped by a mask. The bits of the registers are the same for each UART.
static constexpr uint8_t kRxSize = 64;
static constexpr uint8_t kTxSize = 64;
// Volatile too: the byte must be in its place before the index says so.
static volatile uint8_t rx[kRxSize];
static volatile uint8_t tx[kTxSize];
static volatile uint8_t rxHead, rxTail, txHead, txTail;

static constexpr uint8_t kDataOverrun = 1 << 3, kFrameError = 1 << 4, kDataEmpty = 1 << 5, kSent = 1 << 6;
static constexpr uint8_t kDoubleSpeed = 1 << 1, kSendInterrupt = 1 << 5;

ISR(ASIP_RX_VECTOR) {
    const uint8_t status = ASIP_UCSRA;
    uint8_t byte = ASIP_UDR;
    if (status & (kDataOverrun | kFrameError)) byte = 0;
    uint8_t head = rxHead;
    const uint8_t next = (head + 1) & (kRxSize - 1);
    if (next == rxTail) {
        // Full: what is lost spoils the line it belonged to, so that no half of a request is ever executed.
        rx[(head - 1) & (kRxSize - 1)] = 0;
        return;
    }
    rx[head] = byte;
    rxHead = next;
}

ISR(ASIP_UDRE_VECTOR) {
    uint8_t tail = txTail;
    ASIP_UDR = tx[tail];
    tail = (tail + 1) & (kTxSize - 1);
    txTail = tail;
    if (tail == txHead) ASIP_UCSRB &= static_cast<uint8_t>(~kSendInterrupt);
}

void begin() {
    setRate(kDefaultRate);
    ASIP_UCSRC = 6;     // 8N1
    ASIP_UCSRB = 0x98;  // receive with interrupt, send
}

int16_t read() {
    const uint8_t tail = rxTail;
    if (tail == rxHead) return -1;
    const uint8_t byte = rx[tail];
    rxTail = (tail + 1) & (kRxSize - 1);
    return byte;
}

uint8_t room() {
    return static_cast<uint8_t>(txTail - txHead - 1) & (kTxSize - 1);
}

void write(uint8_t byte) {
    const uint8_t head = txHead;
    if (head == txTail && (ASIP_UCSRA & kDataEmpty)) {
        ASIP_UDR = byte;  // 40 cycles sooner than through the ring
        return;
    }
    const uint8_t next = (head + 1) & (kTxSize - 1);
    while (next == txTail) {
    }
    tx[head] = byte;
    // Interrupts that sent all of the ring in between would leave it empty and this one on, and all of the
    // ring would be sent once more. Found by a robot.
    cli();
    txHead = next;
    ASIP_UCSRB = 0xB8;  // the same bits as in begin(), and the interrupt that sends
    sei();
}

// The flag of a finished byte is cleared when the ring is first seen empty, while the last byte is still on
// the wire; should it have left already, a whole tick of the clock is certainly enough.
bool idle() {
    static uint8_t since;
    static bool waiting;
    const uint8_t now = hw::milliseconds();
    if (txHead != txTail) {
        waiting = false;
        return false;
    }
    if (!waiting) {
        waiting = true;
        since = now;
        ASIP_UCSRA |= kSent;
        return false;
    }
    if (!(ASIP_UCSRA & kSent) && static_cast<uint8_t>(now - since) <= hw::kLongestTick) return false;
    waiting = false;
    return true;
}

// Divisor at double speed, 0 for a rate that the clock cannot make. A byte has to leave 160 cycles for its
// interrupt.
template <uint32_t kBaud>
constexpr uint8_t fastDivisor() {
    return kBaud <= F_CPU / 16 && canDivideTo(F_CPU / 8, kBaud)
               ? static_cast<uint8_t>(divisorFor(F_CPU / 8, kBaud) - 1)
               : 0;
}

static uint8_t divisor(uint16_t hundreds) {
    switch (hundreds) {
        case 1152:
            return fastDivisor<115200>();
        case 2500:
            return fastDivisor<250000>();
        case 5000:
            return fastDivisor<500000>();
        case 10000:
            return fastDivisor<1000000>();
        default:
            return 0;
    }
}

bool canMakeRate(uint16_t hundreds) {
    return hundreds == kDefaultRate || divisor(hundreds) != 0;
}

ASIP_RATE_UNLESS_TOLD bool isRate(uint16_t hundreds) {
    return canMakeRate(hundreds);
}

// The default rate without double speed where that comes close enough: 2.1 % fast at 16 MHz, as the USB chips
// of Arduino boards do it. At 8 MHz it takes double speed.
static constexpr bool kDefaultIsFast = !canDivideTo(F_CPU / 16, kDefaultRate * 100UL);
static constexpr uint8_t kDefaultDivisor =
    divisorFor(kDefaultIsFast ? F_CPU / 8 : F_CPU / 16, kDefaultRate * 100UL) - 1;
static_assert(canDivideTo(kDefaultIsFast ? F_CPU / 8 : F_CPU / 16, kDefaultRate * 100UL),
              "57600 baud cannot be made from this clock");

void setRate(uint16_t hundreds) {
    rxTail = rxHead;
    const uint8_t fast = divisor(hundreds);
    ASIP_UCSRA = kDefaultIsFast || fast != 0 ? kDoubleSpeed : 0;
    ASIP_UBRR = fast != 0 ? fast : kDefaultDivisor;
}

bool usesPin(uint8_t pin) {
#if defined(__AVR_ATmega1284P__) || defined(__AVR_ATmega1284__) || defined(__AVR_ATmega644P__) || \
    defined(__AVR_ATmega644__)
    return digitalPinToPort(pin) == 4 /* D */ && digitalPinToBitMask(pin) <= 2;  // wherever the core numbers
                                                                                 // them
#else
    return pin < 2;
#endif
}

}  // namespace line
}  // namespace asip
