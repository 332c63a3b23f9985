// SPDX-License-Identifier: Apache-2.0
#include "sim/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "asip/text/file_text.hpp"
#include "sim/board_impl.hpp"
#include "sim/chip/image_chip.hpp"

namespace asip::sim {
namespace {

constexpr Cycles kPollCycles = 320;

Expected<std::vector<std::uint8_t>> read_eeprom(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return std::vector<std::uint8_t>{};
    const auto text = text::file_text(file);
    if (!text) return fail(file.string() + ": cannot read the EEPROM file: " + text.error());
    return std::vector<std::uint8_t>(text->begin(), text->end());
}

/// Under another name first: a program that is killed must not leave half an EEPROM.
bool write_eeprom(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
    const auto draft = file.string() + ".new";
    std::ofstream stream(draft, std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    std::error_code error;
    if (stream) std::filesystem::rename(draft, file, error);
    return stream && !error;
}

std::string board_names() {
    std::string names;
    for (const auto& kind : BoardKind::all())
        names += (names.empty() ? "" : ", ") + kind.name;
    return names;
}

}  // namespace

Board::Board(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Board::~Board() {
    save_eeprom();
}

bool Board::save_eeprom() {
    const auto& file = impl_->config_.eeprom;
    if (file.empty()) return true;
    const auto bytes = eeprom();
    if (bytes == impl_->saved_eeprom_) return true;
    if (!write_eeprom(file, bytes)) return false;
    impl_->saved_eeprom_ = bytes;
    return true;
}

Expected<std::unique_ptr<Board>> Board::create(const BoardConfig& config) {
    const auto* kind = BoardKind::find(config.board);
    if (kind == nullptr)
        return fail(fmt::format("there is no board \"{}\": {}", config.board, board_names()));
    if (config.frequency < 1'000'000 || config.frequency > 20'000'000)
        return fail(fmt::format("frequency: {} Hz is not between 1 and 20 MHz", config.frequency));
    const auto parts = plan_parts(config, *kind);
    if (!parts) return fail(parts.error());
    auto image = load_image(config.image);
    if (!image) return fail(image.error());
    auto chip = Chip::create(*kind, config.frequency, *image);
    if (!chip) return fail(config.image.string() + ": " + chip.error());
    const char uart = config.uart != 0 ? config.uart : kind->uart;
    auto* port = (*chip)->uart(uart);
    if (port == nullptr) return fail(fmt::format("uart: the {} has no USART {}", kind->name, uart));
    if (!config.eeprom.empty()) {
        auto bytes = read_eeprom(config.eeprom);
        if (!bytes) return fail(bytes.error());
        (*chip)->set_eeprom(0, *bytes);
    }
    return std::unique_ptr<Board>(
        new Board(std::make_unique<Impl>(config, *kind, *parts, std::move(*image), std::move(*chip), *port)));
}

const BoardConfig& Board::config() const {
    return impl_->config_;
}
const BoardKind& Board::kind() const {
    return impl_->kind_;
}

Cycles Board::cycles() const {
    return impl_->clock_.cycle();
}
SimTime Board::now() const {
    return to_time(cycles());
}
SimTime Board::to_time(Cycles cycles) const {
    const std::uint64_t hertz = impl_->config_.frequency;
    return std::chrono::nanoseconds(
        static_cast<std::int64_t>(cycles / hertz * 1'000'000'000 + cycles % hertz * 1'000'000'000 / hertz));
}

namespace {

Cycles to_cycles(SimTime time, std::uint32_t frequency) {
    const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0));
    // Rounded up: however short the time, it passes.
    return ns / 1'000'000'000 * frequency + (ns % 1'000'000'000 * frequency + 999'999'999) / 1'000'000'000;
}

}  // namespace

void Board::run_for(SimTime simulated) {
    impl_->stop_ = false;
    impl_->run_to(cycles() + to_cycles(simulated, impl_->config_.frequency));
}

bool Board::run_until(const std::function<bool()>& done, SimTime limit) {
    impl_->stop_ = false;
    const Cycles end = cycles() + to_cycles(limit, impl_->config_.frequency);
    while (!done()) {
        if (cycles() >= end) return false;
        impl_->run_to(std::min(end, cycles() + kPollCycles));
    }
    return true;
}

bool Board::alive() const {
    return impl_->chip_->alive();
}

void Board::send(std::string_view bytes) {
    impl_->line_.send(bytes);
}
std::size_t Board::sending() const {
    return impl_->line_.sending();
}

std::string Board::take_output() {
    std::string text;
    for (const auto& received : impl_->received_)
        text.push_back(received.byte);
    impl_->received_.clear();
    return text;
}

std::vector<ReceivedByte> Board::take_bytes() {
    return std::exchange(impl_->received_, {});
}

std::optional<ReceivedLine> Board::read_line(SimTime limit) {
    auto& bytes = impl_->received_;
    const auto is_end = [](const ReceivedByte& received) { return received.byte == '\n'; };
    auto end = std::find_if(bytes.begin(), bytes.end(), is_end);
    if (end == bytes.end()) {
        impl_->stop_ = false;
        impl_->stop_at_newline_ = true;
        impl_->run_to(cycles() + to_cycles(limit, impl_->config_.frequency));
        impl_->stop_at_newline_ = false;
        impl_->stop_ = false;
        end = std::find_if(bytes.begin(), bytes.end(), is_end);
        if (end == bytes.end()) return std::nullopt;
    }
    ReceivedLine line{{}, end->cycle};
    for (auto it = bytes.begin(); it != end; ++it)
        line.text.push_back(it->byte);
    if (!line.text.empty() && line.text.back() == '\r') line.text.pop_back();
    bytes.erase(bytes.begin(), end + 1);
    return line;
}

void Board::on_byte(std::function<void(char)> callback) {
    impl_->on_byte_ = std::move(callback);
}

void Board::set_host_baud(std::uint32_t baud) {
    impl_->line_.set_host_baud(baud);
}
std::uint32_t Board::host_baud() const {
    return impl_->line_.host_baud();
}
std::uint32_t Board::board_baud() const {
    return impl_->line_.board_baud();
}
const LineErrors& Board::line_errors() const {
    return impl_->line_.errors();
}

namespace {

int existing(const BoardKind& kind, int pin) {
    if (pin < 0 || pin >= static_cast<int>(kind.pins.size()))
        throw std::out_of_range(fmt::format("there is no pin {} on the {}", pin, kind.name));
    return pin;
}

}  // namespace

Level Board::pin(int arduino_pin) const {
    return impl_->wiring_.pin(existing(kind(), arduino_pin)).high ? Level::kHigh : Level::kLow;
}
bool Board::is_output(int arduino_pin) const {
    return impl_->wiring_.pin(existing(kind(), arduino_pin)).output;
}
void Board::drive(int arduino_pin, Level level) {
    impl_->wiring_.drive(existing(kind(), arduino_pin), level == Level::kHigh);
}
void Board::release(int arduino_pin) {
    impl_->wiring_.release(existing(kind(), arduino_pin));
}
void Board::set_millivolts(int arduino_pin, int millivolts) {
    impl_->wiring_.set_millivolts(existing(kind(), arduino_pin), millivolts);
}

void Board::on_pin(int arduino_pin, std::function<void(Level)> callback) {
    const bool high = pin(arduino_pin) == Level::kHigh;
    impl_->wiring_.watch(arduino_pin, [before = high, callback = std::move(callback)](PinState now) mutable {
        if (now.high == before) return;
        before = now.high;
        callback(now.high ? Level::kHigh : Level::kLow);
    });
}

Part& Board::part(std::string_view name) {
    auto* part = find_part(name);
    if (part == nullptr) throw std::out_of_range(fmt::format("no part is called \"{}\"", name));
    return *part;
}

Part* Board::find_part(std::string_view name) {
    for (auto& part : impl_->parts_)
        if (part->name() == name) return part.get();
    return nullptr;
}

const std::vector<std::unique_ptr<Part>>& Board::parts() const {
    return impl_->parts_;
}
void Board::on_change(std::function<void(const Change&)> callback) {
    impl_->on_change_ = std::move(callback);
}

void Board::reset() {
    impl_->reset_from_outside(ResetCause::kExternal);
}
void Board::power_cycle() {
    impl_->reset_from_outside(ResetCause::kPowerOn);
}

unsigned Board::resets() const {
    return impl_->resets_;
}
ResetCause Board::last_reset() const {
    return impl_->last_reset_;
}
void Board::on_reset(std::function<void(ResetCause)> callback) {
    impl_->on_reset_ = std::move(callback);
}

std::uint8_t Board::peek(std::uint16_t address) const {
    return address <= impl_->avr().ramend ? impl_->avr().data[address] : 0;
}

void Board::poke(std::uint16_t address, std::uint8_t value) {
    if (address <= impl_->avr().ramend) impl_->avr().data[address] = value;
}

std::optional<std::uint32_t> Board::symbol(std::string_view name) const {
    const auto found = impl_->symbols_.find(name);
    if (found == impl_->symbols_.end()) return std::nullopt;
    return found->second;
}

std::vector<std::uint8_t> Board::eeprom() const {
    return impl_->chip_->eeprom();
}
void Board::set_eeprom(std::size_t offset, const std::vector<std::uint8_t>& bytes) {
    impl_->chip_->set_eeprom(offset, bytes);
}

Expected<void> Board::load(const std::filesystem::path& file) {
    const auto image = load_image(file);
    if (!image) return fail(image.error());
    const std::size_t size = impl_->avr().flashend + std::size_t{1};
    if (auto fits = check_chip(*image, kind(), size); !fits) return fail(file.string() + ": " + fits.error());
    impl_->chip_->set_flash(*image);
    if (!image->eeprom.empty()) set_eeprom(0, image->eeprom);
    reset();
    return {};
}

void Board::watch_stack() {
    impl_->watching_stack_ = true;
    impl_->max_stack_ = impl_->stack_depth();
    impl_->chip_->single_step(true);
}

unsigned Board::max_stack() const {
    return impl_->max_stack_;
}
unsigned Board::stack_now() const {
    return impl_->stack_depth();
}
Cycles Board::idle() const {
    return impl_->idle_loop_->passed();
}
avr_t* Board::raw() {
    return &impl_->avr();
}

}  // namespace asip::sim
