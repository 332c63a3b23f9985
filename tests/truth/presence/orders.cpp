// SPDX-License-Identifier: Apache-2.0
// Presence without chance: every order of six messages of two sessions, with none, any one of them lost, any
// one delivered again at any later place, or any one stored. Each view of the bus takes them and says the
// same of the board after each; where all of them are descriptions, what the highest of the latest session
// said.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <ctime>
#include <numeric>

#include "asip/program/log.hpp"
#include "tests/truth/presence/views.hpp"

namespace {

using namespace std::chrono_literals;
using asip::Time;
using truth::presence::Message;
using truth::presence::View;

constexpr const char* kBoard = "uno1";
// The first ten digits are the start: the second session is the later one.
constexpr std::array<const char*, 2> kSessions = {"006ab13b80ffffff", "006ab13b8a000000"};
constexpr unsigned kMessages = 6;
constexpr auto kApart = 200ms;
constexpr auto kLease = 60s;

/// A description, or a word on `$state`.
struct Said {
    unsigned session;
    unsigned seq;  // 0: a word
    const char* word;
    const char* reason;
};
/// In the order in which they were published.
using Script = std::array<Said, kMessages>;

constexpr const char* kUnplugged = "unplugged";
constexpr const char* kSilent = "silent";

const std::vector<Script> kScripts = {
    {{{0, 1, "online", ""},
      {0, 2, "lost", kUnplugged},
      {0, 3, "online", ""},
      {1, 1, "online", ""},
      {1, 2, "lost", kSilent},
      {1, 3, "online", ""}}},
    {{{0, 1, "online", ""},
      {0, 2, "lost", kUnplugged},
      {0, 3, "offline", "stopped"},
      {1, 1, "online", ""},
      {1, 2, "online", ""},
      {1, 3, "lost", kUnplugged}}},
    {{{0, 1, "lost", kUnplugged},
      {0, 2, "online", ""},
      {1, 1, "lost", kUnplugged},
      {1, 2, "online", ""},
      {1, 3, "updating", "released"},
      {1, 4, "offline", "stopped"}}},
    {{{0, 1, "online", ""},
      {0, 2, "lost", kUnplugged},
      {0, 0, "lost", ""},
      {1, 1, "online", ""},
      {1, 0, "online", ""},
      {1, 2, "lost", kSilent}}},
    {{{0, 1, "online", ""},
      {0, 0, "online", ""},
      {0, 2, "offline", "stopped"},
      {0, 0, "offline", ""},
      {1, 1, "online", ""},
      {1, 0, "online", ""}}},
    {{{0, 1, "lost", kUnplugged},
      {0, 0, "lost", ""},
      {1, 1, "online", ""},
      {1, 0, "online", ""},
      {0, 0, "lost", ""},
      {1, 2, "online", ""}}},
};

struct Delivery {
    unsigned message;
    bool stored;
};
using Deliveries = std::vector<Delivery>;

bool only_descriptions(const Script& script) {
    return std::all_of(script.begin(), script.end(), [](const Said& one) { return one.seq > 0; });
}

Message message(const Said& said, bool stored) {
    const asip::bus::Topics topics;
    Message message;
    message.retain = stored;
    if (said.seq == 0) {
        message.topic = topics.state(kBoard);
        message.payload = said.word;
        return message;
    }
    message.topic = topics.description(kBoard);
    if (stored) message.expiry_seconds = static_cast<std::uint32_t>(kLease.count());
    message.payload = fmt::format(
        R"({{"board":"{}","session":"{}","seq":{},"lease":{},"state":{{"is":"{}",{}"age":0}},)"
        R"("firmware":{{"protocol":"0.4","chip":"ATmega328P","sketch":"AsipHello"}},)"
        R"("link":{{"kind":"serial","path":"/dev/ttyACM0"}},"agent":{{"host":"pi","client":"agent"}},)"
        R"("services":[{{"name":"io","id":"I","model":"io@1","title":"Pins"}}]}})",
        kBoard, kSessions[said.session], said.seq, kLease.count(), said.word,
        *said.reason == '\0' ? "" : fmt::format(R"("reason":"{}",)", said.reason));
    return message;
}

/// What is said of the board, and by which session.
struct Seen {
    std::string state, reason, session;
    std::uint64_t seq = 0;
    bool operator==(const Seen&) const = default;
};
std::string text(const Seen& seen) {
    return fmt::format("{} ({}) by {} {}", seen.state, seen.reason, seen.session, seen.seq);
}

class Trial {
  public:
    Trial() : dice_(1), broker_(dice_, true) {
        views_.push_back(truth::presence::make_registry(broker_, dice_, "r1", now_));
        views_.push_back(truth::presence::make_gateway(broker_, dice_));
        views_.push_back(truth::presence::make_bus_view(broker_));
        for (const auto& view : views_)
            view->start(now_);
    }

    void hear(const Message& message) {
        pass(kApart);
        for (const auto& view : views_)
            view->hear(message, now_);
    }
    void pass(asip::Duration time) {
        now_ += time;
        for (const auto& view : views_)
            view->tick(now_);
    }
    /// As a program that runs does, a few times in each second.
    void pass_slowly(asip::Duration time) {
        for (asip::Duration passed{}; passed < time; passed += 500ms)
            pass(500ms);
    }
    /// Nothing where the views differ: then why.
    std::optional<Seen> seen(std::string& why) {
        std::optional<Seen> first;
        for (const auto& view : views_) {
            const auto item = view->board(kBoard, now_);
            const Seen one = item ? Seen{item->state, item->reason, item->session, item->seq} : Seen{};
            if (first && !(one == *first)) {
                why = fmt::format("{}: {}; {}: {}", views_.front()->name(), text(*first), view->name(),
                                  text(one));
                return std::nullopt;
            }
            first = one;
        }
        return first;
    }
    std::vector<std::string> changes() const { return views_.front()->changes_of(kBoard); }

  private:
    asip::test::Dice dice_;
    truth::presence::SimBroker broker_;
    Time now_ = Time{} + 1h;
    std::vector<std::unique_ptr<View>> views_;
};

// Where both sessions speak in turn, both live: then every view says so in place of a reason.
std::string differs(Seen is, const Seen& should, bool both, const char* when) {
    if (both && is.reason == "conflict" && should.reason.empty()) is.reason.clear();
    return is == should ? std::string() : fmt::format("{}: {} instead of {}", when, text(is), text(should));
}

/// What is wrong; empty: nothing.
std::string play(const Script& script, const Deliveries& deliveries) {
    Trial trial;
    std::string why;
    const Said* latest = nullptr;
    bool spoke[2] = {};
    const auto expect = [&](const Seen& should, const char* when) {
        const auto seen = trial.seen(why);
        if (why.empty() && seen) why = differs(*seen, should, spoke[0] && spoke[1], when);
        return why.empty();
    };
    for (const Delivery& one : deliveries) {
        const Said& said = script[one.message];
        spoke[said.session] = spoke[said.session] || said.seq > 0;
        trial.hear(message(said, one.stored));
        const auto seen = trial.seen(why);
        if (!seen) return why;
        const auto rank = [](const Said& of) { return std::pair(of.session, of.seq); };
        if (latest == nullptr || rank(said) > rank(*latest)) latest = &said;
        if (only_descriptions(script) &&
            !expect({latest->word, latest->reason, kSessions[latest->session], latest->seq}, "on the way"))
            return why;
    }
    // The session that lives says the same again, with its next number: nothing of before counts.
    trial.hear(message({1, 100, "online", ""}, false));
    if (!expect({"online", "", kSessions[1], 100}, "after the next description")) return why;
    const bool undisturbed =
        deliveries.size() == kMessages &&
        std::none_of(deliveries.begin(), deliveries.end(), [](const Delivery& one) { return one.stored; });
    const auto changes = trial.changes();
    if (std::adjacent_find(changes.begin(), changes.end()) != changes.end())
        return fmt::format("the registry reported twice: {}", fmt::join(changes, ", "));
    if (undisturbed) trial.pass_slowly(kLease / 2);
    if (!expect({"online", "", kSessions[1], 100}, "within the lease")) return why;
    if (!undisturbed) return {};
    trial.pass_slowly(kLease);
    if (!expect({"lost", "expired", kSessions[1], 100}, "after the lease")) return why;
    if (trial.changes().back() != "lost expired") return "the registry did not report the end of the lease";
    return {};
}

/// A view that starts after all has what the broker stores, and sees what those see that were there.
std::string play_late(const Script& script) {
    Trial there, late;
    std::string why;
    const Said *description = nullptr, *word = nullptr;
    for (const Said& said : script) {
        there.hear(message(said, false));
        (said.seq > 0 ? description : word) = &said;
    }
    if (description != nullptr) late.hear(message(*description, true));
    if (word != nullptr && word > description) late.hear(message(*word, true));
    const auto first = there.seen(why), second = late.seen(why);
    return first && second ? differs(*second, *first, false, "late") : why;
}

std::string describe(const Script& script, const Deliveries& deliveries) {
    std::string text;
    for (const Delivery& one : deliveries) {
        const Said& said = script[one.message];
        text += fmt::format("{}{}{} {}{}", text.empty() ? "" : ", ", "AB"[said.session],
                            said.seq == 0 ? std::string() : std::to_string(said.seq), said.word,
                            one.stored ? " (stored)" : "");
    }
    return text;
}

/// That order, and what can befall one of its messages.
template <class Each>
void each_fault(const std::array<unsigned, kMessages>& order, Each each) {
    Deliveries whole;
    for (const unsigned message : order)
        whole.push_back({message, false});
    each(whole);
    for (unsigned i = 0; i < kMessages; ++i) {
        Deliveries other = whole;
        other.erase(other.begin() + i);
        each(other);
        other = whole;
        other[i].stored = true;
        each(other);
        for (unsigned again = i + 1; again <= kMessages; ++again) {
            other = whole;
            other.insert(other.begin() + again, whole[i]);
            each(other);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that all views of a board say the same, whatever the order of six messages of two sessions.");
    unsigned allowed = 10;
    app.add_option("--failures", allowed, "Stop after so many failures")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    asip::program::log::configure(asip::program::log::Level::kOff, asip::program::log::Format::kText);
    std::uint64_t played = 0;
    unsigned failures = 0;
    for (const Script& script : kScripts) {
        if (const auto why = play_late(script); !why.empty()) {
            ++failures;
            fmt::print(
                "FAILED: late joiner: {}: {}\n",
                describe(script, {{0, false}, {1, false}, {2, false}, {3, false}, {4, false}, {5, false}}),
                why);
        }
        std::array<unsigned, kMessages> order;
        std::iota(order.begin(), order.end(), 0u);
        do {
            each_fault(order, [&](const Deliveries& deliveries) {
                if (failures >= allowed) return;
                ++played;
                const auto why = play(script, deliveries);
                if (why.empty()) return;
                ++failures;
                fmt::print("FAILED: {}: {}\n", describe(script, deliveries), why);
            });
        } while (std::next_permutation(order.begin(), order.end()));
    }
    fmt::print("{} orders of {} scripts, {:.1f} s of processor time; {} wrong\n", played, kScripts.size(),
               static_cast<double>(std::clock()) / CLOCKS_PER_SEC, failures);
    return failures == 0 && played > 0 ? 0 : 1;
}
