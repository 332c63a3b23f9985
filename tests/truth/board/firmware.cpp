// SPDX-License-Identifier: Apache-2.0
// Compiled twice, with the firmware's namespace under two names: with link extensions and without.
#include "tests/truth/board/firmware.hpp"

#include <optional>
#include <utility>

#include "Asip.h"
#include "FakeHardware.h"

namespace truth {

namespace {

Micros current_time;
std::vector<Effect>* effects;

void on_set(std::uint8_t pin, asip::hw::Fake::Set what, int value) {
    if (!effects) return;
    using Set = asip::hw::Fake::Set;
    const auto kind = what == Set::kMode    ? Effect::Kind::kMode
                      : what == Set::kLevel ? Effect::Kind::kLevel
                                            : Effect::Kind::kDuty;
    effects->push_back({kind, pin, value});
}

class Marks final : public asip::Service {
  public:
    Marks() : Service('W', kHoldsText) {}
    asip::FlashText name() const override { return F("Marks"); }
    void begin() override {}
    asip::Error processRequest(asip::Request& request) override {
        if (request.tag() != 'w') return asip::Error::kUnknownRequest;
        const int number = request.number();
        if (request.more())
            request.text();
        else if (!request.complete())
            return asip::Error::kBadArgument;
        if (!request.complete()) return asip::Error::kBadArgument;
        if (effects) effects->push_back({Effect::Kind::kMark, 0, number});
        return asip::Error::kNone;
    }
};

class Ranger final : public asip::Service {
  public:
    Ranger() : Service('D', 1) {}
    asip::FlashText name() const override { return F("Distance"); }
    void begin() override { measuring_ = false; }
    asip::Error processRequest(asip::Request& request) override {
        if (request.tag() != 'M') return asip::Error::kUnknownRequest;
        if (!request.complete()) return asip::Error::kBadArgument;
        reportValues();
        return asip::Error::kNone;
    }
    void reportValues() override {
        if (measuring_) return;
        measuring_ = true;
        ++value_;
        ready_at_ = current_time + 1000 + value_ * 7919 % 24'000;
    }
    void reportValue(std::uint8_t) override { asip::out.number(value_); }
    void poll() override {
        if (!measuring_ || current_time < ready_at_ || !asip::out.hasRoom()) return;
        measuring_ = false;
        asip::board.sendList(*this, 'e', 1);
    }

  private:
    bool measuring_ = false;
    std::uint16_t value_ = 0;
    Micros ready_at_ = 0;
};

// Static, as the board itself: what its constructor does not set is zero.
asip::Board new_board;

std::optional<Marks> marks;
std::optional<Ranger> ranger;

void set_time(Micros now) {
    current_time = now;
    asip::hw::fake.milliseconds = static_cast<std::uint8_t>(now / 1000);
}

class HostFirmware : public Firmware {
  public:
    std::string power_up(Micros now) override {
        effects = nullptr;
        asip::hw::reset_fake();
        asip::hw::fake.on_set = on_set;
        set_time(now);
        asip::board = new_board;
        asip::out = asip::Out();
        asip::board.add(marks.emplace());
        asip::board.add(ranger.emplace());
        asip::hw::fake.room = 1000;
        asip::board.begin(F("Truth"));
        return std::exchange(asip::hw::fake.from_board, {});
    }
    void run(Micros now, std::string& received, std::size_t room, bool idle, Pass& pass) override {
        auto& fake = asip::hw::fake;
        pass.effects.clear();
        pass.sent.clear();
        set_time(now);
        fake.to_board.swap(received);
        fake.from_board.swap(pass.sent);
        fake.room = room;
        fake.idle = idle;
        pass.read = fake.to_board;
        const auto rate = fake.baud;
        effects = &pass.effects;
        asip::board.run();
        effects = nullptr;
        pass.rate_changed = fake.baud != rate;
        pass.read.resize(pass.rate_changed ? 0 : pass.read.size() - fake.to_board.size());
        pass.text = pass.read;
        fake.to_board.swap(received);
        fake.from_board.swap(pass.sent);
    }
    unsigned baud() const override { return asip::hw::fake.baud; }
};

}  // namespace

Firmware& TRUTH_FIRMWARE() {
    static HostFirmware firmware;
    return firmware;
}

}  // namespace truth
