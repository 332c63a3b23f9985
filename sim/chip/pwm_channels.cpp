// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/pwm_channels.hpp"

#include <vector>

namespace asip::sim {
namespace {

constexpr std::uint8_t kA = 0xc0;
constexpr std::uint8_t kB = 0x30;
constexpr std::uint8_t kC = 0x0c;

constexpr std::uint16_t kTimer0 = 0x44;  // TCCR0A; OCR0A 0x47, OCR0B 0x48
constexpr std::uint16_t kTimer1 = 0x80;  // TCCR1A; OCR1A 0x88, B 0x8a, C 0x8c
constexpr std::uint16_t kTimer2 = 0xb0;  // TCCR2A; OCR2A 0xb3, OCR2B 0xb4
constexpr std::uint16_t kTimer3 = 0x90;
constexpr std::uint16_t kTimer4 = 0xa0;
constexpr std::uint16_t kTimer5 = 0x120;

const std::vector<PwmChannel> kUno = {{6, kTimer0, kA, 0x47},  {5, kTimer0, kB, 0x48},
                                      {9, kTimer1, kA, 0x88},  {10, kTimer1, kB, 0x8a},
                                      {11, kTimer2, kA, 0xb3}, {3, kTimer2, kB, 0xb4}};

const std::vector<PwmChannel> kMega = {
    {13, kTimer0, kA, 0x47},  {4, kTimer0, kB, 0x48},   {11, kTimer1, kA, 0x88}, {12, kTimer1, kB, 0x8a},
    {10, kTimer2, kA, 0xb3},  {9, kTimer2, kB, 0xb4},   {5, kTimer3, kA, 0x98},  {2, kTimer3, kB, 0x9a},
    {3, kTimer3, kC, 0x9c},   {6, kTimer4, kA, 0xa8},   {7, kTimer4, kB, 0xaa},  {8, kTimer4, kC, 0xac},
    {46, kTimer5, kA, 0x128}, {45, kTimer5, kB, 0x12a}, {44, kTimer5, kC, 0x12c}};

// Pins 6 and 13 hang on the Leonardo's timer 4, which simavr does not have.
const std::vector<PwmChannel> kLeonardo = {{11, kTimer0, kA, 0x47},
                                           {3, kTimer0, kB, 0x48},
                                           {9, kTimer1, kA, 0x88},
                                           {10, kTimer1, kB, 0x8a},
                                           {5, kTimer3, kA, 0x98}};

}  // namespace

const PwmChannel* find_pwm_channel(std::string_view board, int pin) {
    if (board == "1284p") return nullptr;  // its timers' registers are not described here
    const auto& channels = board == "mega" ? kMega : board == "leonardo" ? kLeonardo : kUno;
    for (const auto& channel : channels)
        if (channel.pin == pin) return &channel;
    return nullptr;
}

}  // namespace asip::sim
