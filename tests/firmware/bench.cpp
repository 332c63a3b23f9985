// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware/bench.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "asip/Digest.h"
#include "fake_board.hpp"
#include "tests/support/explorer.hpp"

namespace wire {

namespace {

constexpr std::size_t kRoom = 63;
// A name of 32 characters takes 36 passes.
constexpr int kMaxPasses = 100;
constexpr std::uint16_t kDigest = 0x5A17;

struct Calls {
    unsigned number = 0;
    Call last{};
};
Calls calls;
std::array<char, 128> text_of_call;

void note(const Call& call) {
    ++calls.number;
    calls.last = call;
}

class Numbers final : public asip::Service {
  public:
    Numbers() : Service('C') {}
    asip::FlashText name() const override { return F("Numbers"); }
    void begin() override {}
    asip::Error processRequest(asip::Request& request) override {
        if (request.tag() != 'm') return asip::Error::kUnknownRequest;
        const std::int32_t first = request.signedNumber();
        const std::int32_t second = request.more() ? request.number() : -1;
        if (!request.complete()) return asip::Error::kBadArgument;
        note({'C', first, second, {}});
        return asip::Error::kNone;
    }
};

class Texts final : public asip::Service {
  public:
    Texts() : Service('E', kHoldsText) {}
    asip::FlashText name() const override { return F("Texts"); }
    void begin() override {}
    asip::Error processRequest(asip::Request& request) override {
        if (request.tag() != 'm') return asip::Error::kUnknownRequest;
        const std::int32_t number = request.number();
        const char* const text = request.text();
        if (!request.complete()) return asip::Error::kBadArgument;
        const auto length = std::min(std::strlen(text), text_of_call.size());
        std::memcpy(text_of_call.data(), text, length);
        note({'E', number, -1, {text_of_call.data(), length}});
        return asip::Error::kNone;
    }
};

void on_set(std::uint8_t pin, asip::hw::Fake::Set what, int value) {
    if (what == asip::hw::Fake::Set::kLevel) note({'I', pin, value, {}});
}

Numbers numbers;
Texts texts;

}  // namespace

Bench::Bench(bool with_inputs) {
    numbers = Numbers();
    texts = Texts();
    asip::FakeBoard({&numbers, &texts}, !with_inputs);
    asip::hw::fake.on_set = on_set;
}

void Bench::pass() {
    asip::hw::fake.room = kRoom;
    asip::board.run();
}

/// Until the board has nothing to do. False: it does not come to an end.
bool Bench::settle() {
    std::array<std::byte, sizeof(asip::Board)> before;
    for (int passes = 0; passes < kMaxPasses; ++passes) {
        const auto sent = asip::hw::fake.from_board.size();
        std::memcpy(before.data(), static_cast<const void*>(&asip::board), before.size());
        pass();
        const bool still =
            asip::hw::fake.from_board.size() == sent &&
            std::memcmp(before.data(), static_cast<const void*>(&asip::board), before.size()) == 0;
        if (still) return true;
    }
    return false;
}

const char* Bench::byte(std::uint8_t byte) {
    auto& fake = asip::hw::fake;
    fake.from_board.clear();
    calls.number = 0;
    fake.to_board.push_back(static_cast<char>(byte));
    pass();
    if (judge_.may_end_at(byte) && !settle()) return "it does not come to an end";
    if (!fake.to_board.empty()) return "it does not read on";
    executed_ += calls.number;
    return judge_.byte(byte, {fake.from_board, calls.number, calls.last, asip::FakeBoard::digest()});
}

const char* Bench::second_of_silence() {
    constexpr std::uint8_t kStep = 251;
    constexpr int kSteps = 4;
    auto& fake = asip::hw::fake;
    fake.from_board.clear();
    calls.number = 0;
    for (int i = 0; i < kSteps; ++i) {
        fake.milliseconds = static_cast<std::uint8_t>(fake.milliseconds + kStep);
        pass();
    }
    if (!settle()) return "it does not come to an end";
    executed_ += calls.number;
    return judge_.second_of_silence({fake.from_board, calls.number, calls.last, asip::FakeBoard::digest()});
}

const char* Bench::bytes(std::string_view bytes) {
    for (const char c : bytes)
        if (const char* wrong = byte(static_cast<std::uint8_t>(c))) return wrong;
    return nullptr;
}

const char* Bench::step(int symbol) {
    const char* const wrong = try_symbol(symbol);
    if (judge_.digest() == 0) return wrong;
    judge_.take_digest(kDigest);
    asip::FakeBoard::set_digest(kDigest);
    return wrong;
}

bool Bench::digests_agree() {
    for (unsigned digest = 0; digest <= 0xFFFF; ++digest)
        for (unsigned byte = 0; byte <= 0xFF; ++byte) {
            const auto before = static_cast<std::uint16_t>(digest);
            const auto next = static_cast<std::uint8_t>(byte);
            if (asip::digestOf(before, next) != Judge::digest_of(before, next)) return false;
        }
    return true;
}

const char* Bench::try_symbol(int symbol) {
    if (symbol == kSilence) return second_of_silence();
    if (symbol != kRightEnd) return byte(static_cast<std::uint8_t>(symbol));
    unsigned sum = 0;
    for (const char c : judge_.text())
        sum ^= static_cast<unsigned char>(c);
    constexpr char kHex[] = "0123456789ABCDEF";
    return bytes(std::string{'*', kHex[sum / 16], kHex[sum % 16], '\n'});
}

bool Bench::ends_at(int symbol) const {
    if (symbol == kRightEnd || symbol == '\n') return (symbol == kRightEnd) == judge_.uses_checksums();
    return symbol == ',' && judge_.may_end_at(',');
}

void Bench::save(State& state) const {
    asip::FakeBoard::spoil_old_bytes();
    std::memset(static_cast<void*>(&state), 0, sizeof state);  // what lies between its members, too
    std::memcpy(state.board.data(), static_cast<const void*>(&asip::board), state.board.size());
    std::memcpy(state.out.data(), static_cast<const void*>(&asip::out), state.out.size());
    std::memcpy(static_cast<void*>(&state.judge), static_cast<const void*>(&judge_), sizeof judge_);
}

void Bench::put_back(const State& state) {
    std::memcpy(static_cast<void*>(&asip::board), state.board.data(), state.board.size());
    std::memcpy(static_cast<void*>(&asip::out), state.out.data(), state.out.size());
    std::memcpy(static_cast<void*>(&judge_), static_cast<const void*>(&state.judge), sizeof judge_);
    asip::hw::fake.milliseconds = asip::FakeBoard::last_millisecond();
}

}  // namespace wire
