// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/parts/i2c_chip.hpp"
#include "sim/parts/numbers.hpp"

namespace asip::sim {

const PartKind& sht31_part();

namespace sht31 {

constexpr std::array kQuantities{Quantity{"temperature", 20, -40, 125}, Quantity{"humidity", 40, 0, 100}};

// From the data sheet of the SHT3x. Commands are two bytes; each word that it sends has a checksum.
constexpr std::uint8_t kAddress = 0x44;
constexpr std::uint16_t kReset = 0x30a2, kStatus = 0xf32d, kClearStatus = 0x3041, kSerial = 0x3780;
constexpr std::uint16_t kHeaterOn = 0x306d, kHeaterOff = 0x3066;
constexpr std::uint16_t kAfterReset = 0x8010, kHeater = 0x2000;
constexpr std::uint16_t kSerialHigh = 0x0a51, kSerialLow = 0xb731;
struct Single {
    std::uint16_t command;
    double us;  ///< it takes at most
};
constexpr std::array kSingles{Single{0x2400, 15500}, Single{0x240b, 6500}, Single{0x2416, 4500}};

std::uint8_t checksum(unsigned word) {
    unsigned sum = 0xff;
    for (unsigned at = 0; at < 16; ++at) {
        if (at % 8 == 0) sum ^= word >> (8 - at) & 0xff;
        sum = (sum << 1 ^ ((sum & 0x80) != 0 ? 0x31 : 0)) & 0xff;
    }
    return static_cast<std::uint8_t>(sum);
}

/// A sensor of temperature and humidity that measures when it is told so, without holding the clock: it does
/// not acknowledge a read before the measurement is there. It measures not by itself.
class Sht31 final : public I2cChip {
  public:
    Sht31(std::string name, std::uint8_t address, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), sht31_part(), address, kQuantities, std::move(values), context),
          ready_(context.clock, [this] { finish(); }) {}

    bool is_ready_to_read() const override { return !answer_.empty(); }
    void started(bool) override { byte_ = 0; }
    bool write(std::uint8_t byte) override {
        command_ = static_cast<std::uint16_t>(command_ << 8 | byte);
        if (++byte_ == 2) execute();
        return true;
    }
    std::uint8_t read() override {
        const auto byte = byte_ < answer_.size() ? answer_[byte_] : std::uint8_t{0xff};
        if (++byte_ == answer_.size()) answer_.clear();
        return byte;
    }

  private:
    std::uint8_t read_register(std::uint8_t) override { return 0; }
    void write_register(std::uint8_t, std::uint8_t) override {}
    void power_on() override {
        ready_.cancel();
        status_ = kAfterReset;
        answer_.clear();
    }
    Expected<void> perform(std::string_view verb, std::string_view argument) override {
        if (verb != "damage") return I2cChip::perform(verb, argument);
        const auto count = parse_number(argument);
        if (!count || *count < 0 || *count > 1000)
            return fail("a number of measurements from 0 to 1000 is damaged");
        to_damage_ = static_cast<int>(*count);
        return {};
    }

    void execute() {
        answer_.clear();
        for (const auto& single : kSingles)
            if (single.command == command_)
                ready_.at(context().clock.cycle() +
                          static_cast<std::uint64_t>(single.us * context().cycles_per_us));
        if (command_ == kReset) power_on();
        if (command_ == kStatus) say(status_);
        if (command_ == kClearStatus) status_ &= kHeater;
        if (command_ == kHeaterOn) status_ |= kHeater;
        if (command_ == kHeaterOff) status_ &= static_cast<std::uint16_t>(~kHeater);
        if (command_ != kSerial) return;
        say(kSerialHigh);
        say(kSerialLow);
    }
    void finish() {
        say(static_cast<unsigned>(std::lround((value(0) + 45) / 175 * 65535)));
        say(static_cast<unsigned>(std::lround(value(1) / 100 * 65535)));
        if (to_damage_ == 0) return;
        --to_damage_;
        answer_[4] ^= 1;
    }
    void say(unsigned word) {
        for (const auto byte : {word >> 8, word & 0xff})
            answer_.push_back(static_cast<std::uint8_t>(byte));
        answer_.push_back(checksum(word));
    }

    Alarm ready_;
    std::size_t byte_ = 0;
    std::uint16_t command_ = 0, status_ = kAfterReset;
    int to_damage_ = 0;
    std::vector<std::uint8_t> answer_;
};

PartPlan read_sht31(PartReader& reader) {
    const auto address =
        static_cast<std::uint8_t>(reader.number("address", kAddress, kAddress, kAddress + 1));
    return read_i2c_chip<Sht31>(reader, kQuantities, address);
}

constexpr std::array kSht31Verbs{I2cChip::kVerbs[0], I2cChip::kVerbs[1], I2cChip::kVerbs[2],
                                 PartVerb{"damage", "COUNT", "damage so many answers of a sensor"}};

}  // namespace sht31

const PartKind& sht31_part() {
    static constexpr PartKind kind{"sht31", sht31::kSht31Verbs, sht31::read_sht31};
    return kind;
}

}  // namespace asip::sim
