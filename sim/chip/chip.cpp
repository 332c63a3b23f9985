// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/chip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <utility>

#include "sim/chip/image_chip.hpp"

namespace asip::sim {
namespace {

constexpr std::uint64_t kInterruptEntryCycles = 4;
constexpr int kSupplyMillivolts = 5000;

void ignore_log(avr_t*, int, const char*, va_list) {}

void sleep_takes_no_time(avr_t*, avr_cycle_count_t) {}

/// A longer copy, with zeros behind `size`: what the system keeps no memory for until it is written.
void make_room(std::uint8_t*& memory, std::size_t size, std::size_t addresses) {
    if (size >= addresses) return;
    auto* const longer = static_cast<std::uint8_t*>(std::calloc(addresses, 1));
    if (longer == nullptr) throw std::bad_alloc();
    std::memcpy(longer, memory, size);
    std::free(std::exchange(memory, longer));
}

/// simavr writes wherever the stack pointer shows, and reads wherever RAMPZ and Z do (ELPM), beyond the end
/// of the chip's memory, too.
void make_room_for_every_address(avr_t& avr) {
    make_room(avr.data, avr.ramend + std::size_t{1}, 0x10000);
    make_room(avr.flash, avr.flashend + std::size_t{1}, 0x1000000);
}

void interrupt_entered(avr_irq_t*, std::uint32_t running, void* param) {
    if (running != 0) static_cast<avr_t*>(param)->cycle += kInterruptEntryCycles;
}

}  // namespace

Expected<std::unique_ptr<Chip>> Chip::create(const BoardKind& kind, std::uint32_t frequency,
                                             const Image& image) {
    static std::once_flag logger_set;
    std::call_once(logger_set, [] { avr_global_logger_set(ignore_log); });

    avr_t* avr = avr_make_mcu_by_name(kind.chip.c_str());
    if (avr == nullptr) return fail(fmt::format("simavr does not know the chip {}", kind.chip));
    avr_init(avr);
    make_room_for_every_address(*avr);
    std::unique_ptr<Chip> chip(new Chip(avr));
    if (auto fits = check_chip(image, kind, avr->flashend + std::size_t{1}); !fits) return fail(fits.error());
    avr->frequency = frequency;
    avr->vcc = avr->avcc = avr->aref = kSupplyMillivolts;
    avr->sleep = sleep_takes_no_time;
    chip->set_flash(image);
    avr->pc = avr->reset_pc;
    if (!image.eeprom.empty()) chip->set_eeprom(0, image.eeprom);
    chip->single_step(false);
    return chip;
}

Chip::Chip(avr_t* avr) : avr_(avr) {
    hook_.chip = this;
    hook_.io.kind = "asip-reset";
    hook_.io.avr = avr;
    hook_.io.reset = [](avr_io_t* io) {
        auto& chip = *reinterpret_cast<ResetHook*>(io)->chip;
        chip.apply_fixes();
        if (chip.reset_callback_) chip.reset_callback_();
    };
    // Last in the list, so that it comes after the modules' own resets.
    auto** end = &avr->io_port;
    while (*end != nullptr)
        end = &(*end)->next;
    *end = &hook_.io;
    add_pin_changes();
    count_interrupt_entries();
    apply_fixes();
}

Chip::~Chip() {
    for (auto** io = &avr_->io_port; *io != nullptr; io = &(*io)->next)
        if (*io == &hook_.io) {
            *io = nullptr;
            break;
        }
    free_what_terminate_leaves();
    avr_terminate(avr_);
    std::free(avr_->irq_pool.irq);
    std::free(avr_);
}

void Chip::free_what_terminate_leaves() {
    for (auto& io : avr_->io) {
        avr_free_irq(io.irq, AVR_IOMEM_IRQ_ALL + 1);
        io.irq = nullptr;
    }
    for (unsigned i = 0; i < avr_->interrupts.vector_count; ++i)
        if (auto* vector = avr_->interrupts.vector[i]) avr_free_irq(vector->irq, AVR_INT_IRQ_COUNT);
    avr_free_irq(avr_->interrupts.irq, AVR_INT_IRQ_COUNT);
}

void Chip::apply_fixes() {
    // A reset turns this back on.
    avr_extint_set_strict_lvl_trig(avr_, EXTINT_IRQ_OUT_INT0, 0);
    avr_extint_set_strict_lvl_trig(avr_, EXTINT_IRQ_OUT_INT1, 0);
    for (char name = '0'; name <= '3'; ++name) {
        std::uint32_t flags = 0;
        if (uart(name) != nullptr) avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS(name), &flags);
    }
}

// simavr 1.6 has those of port B of a Mega alone. Port K is A8 to A15; its registers are those of the data
// sheet.
void Chip::add_pin_changes() {
    constexpr std::uint16_t kPcifr = 0x3b, kPcicr = 0x68, kPcmsk2 = 0x6d;
    constexpr std::uint8_t kVector = 11, kBit = 2;
    for (auto* io = avr_->io_port; io != nullptr; io = io->next) {
        if (std::strcmp(io->kind, "port") != 0) continue;
        auto* port = static_cast<avr_ioport_t*>(static_cast<void*>(io));  // begins with the avr_io_t
        if (port->name != 'K' || port->r_pcint != 0) continue;
        port->r_pcint = kPcmsk2;
        port->pcint.vector = kVector;
        port->pcint.enable = AVR_IO_REGBIT(kPcicr, kBit);
        port->pcint.raised = AVR_IO_REGBIT(kPcifr, kBit);
        avr_register_vector(avr_, &port->pcint);
    }
}

void Chip::count_interrupt_entries() {
    for (unsigned i = 0; i < avr_->interrupts.vector_count; ++i)
        if (auto* vector = avr_->interrupts.vector[i])
            avr_irq_register_notify(vector->irq + AVR_INT_IRQ_RUNNING, interrupt_entered, avr_);
}

avr_uart_t* Chip::uart(char name) {
    for (auto* io = avr_->io_port; io != nullptr; io = io->next) {
        if (std::strcmp(io->kind, "uart") != 0) continue;
        auto* port = static_cast<avr_uart_t*>(static_cast<void*>(io));  // begins with the avr_io_t
        if (port->name == name) return port;
    }
    return nullptr;
}

bool Chip::alive() const {
    return avr_->state != cpu_Done && avr_->state != cpu_Crashed && avr_->state != cpu_Stopped;
}

void Chip::cancel_unknown_timers() {
    for (auto* io = avr_->io_port; io != nullptr; io = io->next) {
        if (std::strcmp(io->kind, "timer") != 0) continue;
        auto* timer = static_cast<avr_timer_t*>(static_cast<void*>(io));
        if (timer->mode.kind != avr_timer_wgm_none) continue;
        for (auto* slot = avr_->cycle_timers.timer; slot != nullptr;) {
            auto* next = slot->next;
            if (slot->param == timer) avr_cycle_timer_cancel(avr_, slot->timer, timer);
            slot = next;
        }
    }
}

std::vector<std::uint8_t> Chip::eeprom() {
    std::vector<std::uint8_t> bytes(avr_->e2end + std::size_t{1}, 0xff);
    avr_eeprom_desc_t all{bytes.data(), 0, static_cast<std::uint32_t>(bytes.size())};
    avr_ioctl(avr_, AVR_IOCTL_EEPROM_GET, &all);  // its result is always -1
    return bytes;
}

void Chip::set_flash(const Image& image) {
    std::memset(avr_->flash, 0xff, avr_->flashend + std::size_t{1});
    std::memcpy(avr_->flash, image.flash.data(), image.flash.size());
    avr_->codeend = static_cast<std::uint32_t>(image.flash.size());
    const auto begin =
        std::find_if(image.flash.begin(), image.flash.end(), [](std::uint8_t byte) { return byte != 0xff; });
    const auto start = begin == image.flash.end() ? 0 : begin - image.flash.begin();
    avr_->reset_pc = static_cast<std::uint32_t>(start) & ~1u;
}

void Chip::set_eeprom(std::size_t offset, const std::vector<std::uint8_t>& bytes) {
    const std::size_t size = avr_->e2end + std::size_t{1};
    if (offset >= size || bytes.empty()) return;
    auto copy = bytes;
    avr_eeprom_desc_t part{copy.data(), static_cast<std::uint16_t>(offset),
                           static_cast<std::uint32_t>(std::min(copy.size(), size - offset))};
    avr_ioctl(avr_, AVR_IOCTL_EEPROM_SET, &part);
}

}  // namespace asip::sim
