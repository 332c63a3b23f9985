// SPDX-License-Identifier: Apache-2.0
#include "sim/wiring/part_plan.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/text/nearest.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {
namespace {

using text::JsonReader;

constexpr int kReadableChannels = 8;  // simavr's ADC has no more; the mega's A8 to A15 read 0 there
constexpr unsigned kMaxTimers = 32;   // of simavr's 64

bool can_share(PinUse a, PinUse b) {
    if (a == PinUse::kBus || b == PinUse::kBus) return true;
    return (a == PinUse::kJoins && b != PinUse::kDrives) || (b == PinUse::kJoins && a != PinUse::kDrives);
}

/// The pins of the USART that the host is connected to.
std::pair<int, int> serial_pins(const BoardConfig& config, const BoardKind& kind) {
    if (kind.name != "mega" || config.uart == 0 || config.uart == '0') return {0, 1};
    if (config.uart == '1') return {18, 19};
    if (config.uart == '2') return {16, 17};
    return {14, 15};
}

const PartKind* find_kind(const PartConfig& part, JsonReader& reader) {
    std::vector<std::string_view> names;
    for (const auto* kind : PartKind::all())
        names.push_back(kind->name);
    const auto* kind = PartKind::find(part.kind);
    if (part.kind.empty())
        reader.fault("kind", fmt::format("is missing; one of {}", fmt::join(names, ", ")));
    else if (kind == nullptr)
        reader.fault("kind", fmt::format("there is no part \"{}\"{}; one of {}", part.kind,
                                         text::did_you_mean(part.kind, names), fmt::join(names, ", ")));
    return kind;
}

PlannedPart plan_part(const PartConfig& part, JsonReader& reader, const BoardConfig& config,
                      const BoardKind& board) {
    PlannedPart planned{part.name, {}};
    const auto* kind = find_kind(part, reader);
    if (kind == nullptr) return planned;
    PartReader settings(reader, board, config.world != nullptr);
    planned.plan = kind->read(settings);
    reader.refuse_others();
    if (planned.name.empty()) planned.name = part.kind + std::to_string(planned.plan.claims.front().pin);
    if (planned.name.find_first_of(" \t/") != std::string::npos)
        reader.fault("name", "a part's name has no spaces and no \"/\" in it");
    return planned;
}

/// Which part has which pin of a board.
class Pins {
  public:
    Pins(const BoardConfig& config, const BoardKind& board) : board_(board) {
        const auto [first, second] = serial_pins(config, board);
        for (const int pin : {first, second})
            held_.emplace(pin, Holder{"the serial port", PinUse::kDrives});
    }

    Expected<void> claim(const PlannedPart& part) {
        if (!names_.insert(part.name).second) return fail("another part has this name");
        timers_ += part.plan.timers;
        if (timers_ > kMaxTimers)
            return fail(fmt::format("the parts of one board need more than {} timers", kMaxTimers));
        for (const auto& claim : part.plan.claims)
            if (auto claimed = claim_pin(part.name, claim); !claimed) return claimed;
        return {};
    }

  private:
    struct Holder {
        std::string name;
        PinUse use;
    };

    Expected<void> claim_pin(const std::string& name, const PinClaim& claim) {
        const int channel = board_.pins.at(static_cast<std::size_t>(claim.pin)).channel;
        if (claim.analog && channel < 0)
            return fail(fmt::format("pin {} of the {} is not an analog input", claim.pin, board_.name));
        if (claim.analog && channel >= kReadableChannels)
            return fail(fmt::format("simavr cannot read pin {}: it has only the first {} analog channels",
                                    claim.pin, kReadableChannels));
        const auto [first, last] = held_.equal_range(claim.pin);
        for (auto it = first; it != last; ++it)
            if (!can_share(it->second.use, claim.use))
                return fail(fmt::format("pin {} is taken by {}", claim.pin, it->second.name));
        held_.emplace(claim.pin, Holder{name, claim.use});
        return {};
    }

    const BoardKind& board_;
    std::multimap<int, Holder> held_;
    std::set<std::string> names_;
    unsigned timers_ = 0;
};

}  // namespace

Expected<std::vector<PlannedPart>> plan_parts(const BoardConfig& config, const BoardKind& board) {
    std::vector<PlannedPart> plans;
    Pins pins(config, board);
    for (const auto& part : config.parts) {
        const auto place = fmt::format("/parts/{}", plans.size());
        std::string fault;
        JsonReader reader(part.settings, place, fault);
        plans.push_back(plan_part(part, reader, config, board));
        if (!fault.empty()) return fail(fault);
        if (auto claimed = pins.claim(plans.back()); !claimed)
            return fail(fmt::format("{}: {}: {}", place, plans.back().name, claimed.error()));
    }
    return plans;
}

}  // namespace asip::sim
