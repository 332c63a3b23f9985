#include "sim/pin_claims.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

namespace asip::sim {
namespace {

constexpr int kReadableChannels = 8;      // simavr's ADC has no more; the mega's A8 to A15 read 0 there
constexpr unsigned kMostTimedParts = 32;  // each needs one of simavr's 64 timers

/// Parts that listen only can share a pin with a wire; whatever drives a pin has it alone.
enum class Use { listens, joins, drives };

struct Claim {
    int pin;
    Use use;
    bool analog = false;
};

struct ClaimsOf {
    std::vector<Claim> operator()(const LedSpec& s) const { return {{s.pin, Use::listens}}; }
    std::vector<Claim> operator()(const ButtonSpec& s) const { return {{s.pin, Use::drives}}; }
    std::vector<Claim> operator()(const WireSpec& s) const {
        return {{s.from, Use::joins}, {s.to, Use::joins}};
    }
    std::vector<Claim> operator()(const PotentiometerSpec& s) const { return {{s.pin, Use::drives, true}}; }
    std::vector<Claim> operator()(const UltrasonicSpec& s) const {
        if (s.trigger == s.echo) return {{s.trigger, Use::drives}};
        return {{s.trigger, Use::listens}, {s.echo, Use::drives}};
    }
    std::vector<Claim> operator()(const ServoSpec& s) const { return {{s.pin, Use::listens}}; }
    std::vector<Claim> operator()(const SquareWaveSpec& s) const { return {{s.pin, Use::drives}}; }
};

bool can_share(Use a, Use b) {
    return (a == Use::joins && b != Use::drives) || (b == Use::joins && a != Use::drives);
}

struct Holder {
    std::string name;
    Use use;
};

Expected<void> check_claim(const std::string& name, const Claim& claim, const BoardKind& kind,
                           std::multimap<int, Holder>& held) {
    if (claim.pin < 0 || claim.pin >= static_cast<int>(kind.pins.size()))
        return fail(fmt::format("there is no pin {} on the {} (0 to {})", claim.pin, kind.name,
                                kind.pins.size() - 1));
    const int channel = kind.pins[static_cast<std::size_t>(claim.pin)].channel;
    if (claim.analog && channel < 0)
        return fail(fmt::format("pin {} of the {} is not an analog input", claim.pin, kind.name));
    if (claim.analog && channel >= kReadableChannels)
        return fail(fmt::format("simavr cannot read pin {}: it has only the first {} analog channels",
                                claim.pin, kReadableChannels));
    const auto [first, last] = held.equal_range(claim.pin);
    for (auto it = first; it != last; ++it)
        if (!can_share(it->second.use, claim.use))
            return fail(fmt::format("pin {} is taken by {}", claim.pin, it->second.name));
    held.emplace(claim.pin, Holder{name, claim.use});
    return {};
}

/// The pins of the USART that the host is connected to.
std::pair<int, int> serial_pins(const BoardConfig& config, const BoardKind& kind) {
    if (kind.name != "mega" || config.uart == 0 || config.uart == '0') return {0, 1};
    if (config.uart == '1') return {18, 19};
    if (config.uart == '2') return {16, 17};
    return {14, 15};
}

}  // namespace

Expected<void, PartFault> check_parts(const BoardConfig& config, const BoardKind& kind) {
    std::multimap<int, Holder> held;
    const auto [first, second] = serial_pins(config, kind);
    held.emplace(first, Holder{"the serial port", Use::drives});
    held.emplace(second, Holder{"the serial port", Use::drives});
    std::set<std::string> names;
    unsigned timed = 0;
    for (std::size_t i = 0; i < config.parts.size(); ++i) {
        const auto fault = [i](std::string reason) {
            return Unexpected<PartFault>(PartFault{i, std::move(reason)});
        };
        const auto& part = config.parts[i];
        if (part.name.empty()) return fault("it has no name");
        if (!names.insert(part.name).second) return fault("another part has this name");
        for (const auto& claim : std::visit(ClaimsOf{}, part.spec))
            if (auto checked = check_claim(part.name, claim, kind, held); !checked)
                return fault(checked.error());
        if (std::holds_alternative<UltrasonicSpec>(part.spec) ||
            std::holds_alternative<SquareWaveSpec>(part.spec))
            ++timed;
        if (timed > kMostTimedParts)
            return fault(fmt::format("more than {} ultrasonic sensors and square waves on one board",
                                     kMostTimedParts));
    }
    return {};
}

}  // namespace asip::sim
