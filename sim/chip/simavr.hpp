// SPDX-License-Identifier: Apache-2.0
#pragma once
// simavr's headers, for the files that talk to it.
#include <simavr/sim_avr.h>
// sim_avr.h must be included first.
#include <simavr/avr_adc.h>
#include <simavr/avr_eeprom.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_spi.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_twi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>
#include <simavr/sim_irq.h>

#include <cstddef>

namespace asip::sim {

inline constexpr std::size_t kIoBase = 0x20;  ///< simavr's table of I/O handlers starts behind the 32
                                              ///< registers

}  // namespace asip::sim
