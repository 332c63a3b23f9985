// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/pin_group.hpp"

#include <list>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/json.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/board_values.hpp"
#include "cli/ask/side_by_side.hpp"
#include "cli/find/chosen_boards.hpp"
#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using protocol::PinMode;

constexpr const char* kIo = "io";

/// One board of the group: its modes are asked for, then comes what the word needs, or a value is waited for.
struct Member {
    KnownBoard board;
    model::Description description;
    int pin = 0;
    PinReading reading{};
    std::size_t unanswered = 0;
    bool wants_value = false;
    std::optional<bus::Reply> failed{};  ///< the first that was no success
    bool done = false;
    std::string analog_channel{};
    std::list<BusSession::Call> calls{};
    BusSession::Subscription reports{};
    std::optional<BusSession::Demand> demand{};
    std::unique_ptr<BoardValues> values{};

    const std::string& name() const { return board.item.board; }
};

class PinGroup {
  public:
    PinGroup(const PinOptions& options, Environment& environment, BusSession& session)
        : options_(options), environment_(environment), session_(session) {}

    int run(const std::vector<KnownBoard>& boards) {
        if (const auto prepared = prepare(boards); !prepared) return environment_.fail_with(prepared.error());
        std::list<Member*> there;
        for (auto& member : members_)
            if (!member.failed) there.push_back(&member);
        ask_side_by_side(
            session_, std::move(there), kAskedAtOnce, [this](Member& member) { return begin(member); },
            [](const Member& member) { return member.done || knows_level(member); });
        for (auto& member : members_)
            if (knows_level(member)) take_level(member);
        return report();
    }

  private:
    Outcome<void> prepare(const std::vector<KnownBoard>& boards) {
        if (!options_.word.empty()) action_ = *parse_pin_word(options_.word);
        std::string offline;
        for (const auto& board : boards) {
            if (board.item.state == "offline") {
                offline += (offline.empty() ? "" : ", ") + board.item.board;
                continue;
            }
            auto description = board.description.value_or(model::Description());
            const auto pin = find_pin(options_.pin, description);
            if (!pin) return failure(pin.error().status, board.item.board + ": " + pin.error().text);
            auto& member = members_.emplace_back(Member{board, std::move(description), *pin});
            if (board.item.state == "lost") member.failed = refused_as_lost(board.item, "nothing was sent");
        }
        if (!offline.empty()) environment_.note("offline, left out: " + offline);
        if (members_.empty()) return failure(program::kExitNoAnswer, "none of these boards is there");
        return {};
    }

    std::string topic_of(const Member& member) const {
        return environment_.topics.service_in(member.name(), kIo);
    }

    Time begin(Member& member) {
        if (!action_)
            member.reports = session_.subscribe(
                environment_.topics.service_out(member.name(), kIo),
                [this, &member](const mqtt::Message& message) { take_report(member, message); });
        send(member, "p", [this, &member](const bus::Reply& reply) { take_modes(member, reply); });
        return Clock::now() + 2 * (environment_.timeout + caller::Caller::kAnswerTime);
    }

    template <class Next>
    void send(Member& member, const std::string& text, Next next) {
        ++member.unanswered;
        // A call outlives its answer: it may be in the middle of handing it over.
        member.calls.push_back(session_.command({.topic = topic_of(member), .payload = text},
                                                [this, &member, next](const bus::Reply& reply) {
                                                    if (member.done) return;
                                                    --member.unanswered;
                                                    if (reply.succeeded()) return next(reply);
                                                    if (!member.failed) member.failed = reply;
                                                    finish_if_answered(member);
                                                }));
    }

    void finish_if_answered(Member& member) {
        if (member.unanswered == 0 && (member.failed || !member.wants_value)) member.done = true;
    }

    void fail(Member& member, const std::string& why) {
        member.failed = bus::Reply::refused("pin", why);
        member.done = true;
    }

    void take_modes(Member& member, const bus::Reply& reply) {
        const auto modes = modes_of(reply.answer);
        if (!modes) return fail(member, modes.error().text);
        const auto index = static_cast<std::size_t>(member.pin);
        if (index >= modes->size())
            return fail(member, "it has pins 0 to " + std::to_string(modes->size() - 1));
        member.reading.mode = (*modes)[index];
        if (action_) {
            const auto answered = [this, &member](const bus::Reply&) { finish_if_answered(member); };
            for (const auto& request : pin_requests(member.pin, *action_, member.reading.mode))
                send(member, request, answered);
            member.reading.mode = action_->mode;
            if (action_->kind == PinAction::Kind::kWrite) member.reading.value = action_->value;
        } else {
            read(member);
        }
        finish_if_answered(member);
    }

    void read(Member& member) {
        if (protocol::is_digital_input(member.reading.mode)) {
            member.wants_value = true;
            member.values = std::make_unique<BoardValues>(environment_, session_, member.board, kIo);
        } else if (member.reading.mode == PinMode::kAnalog) {
            for (const auto& [pin, channel] : member.description.pins.analog)
                if (pin == member.pin) member.analog_channel = std::to_string(channel);
            member.wants_value = true;
            member.demand = session_.demand(member.name(), kIo);
        }
    }

    static bool knows_level(const Member& member) {
        return member.values && member.wants_value && member.values->answered();
    }

    void take_level(Member& member) {
        member.reading.value = pin_value(member.values->pins(), "digital", member.pin);
        member.wants_value = !member.reading.value;
        finish_if_answered(member);
    }

    void take_report(Member& member, const mqtt::Message& message) {
        if (message.retain || !member.wants_value || member.done) return;
        const auto document = model::parse_json(message.payload);
        if (!document || !document->is_object()) return;
        const bool analog = member.reading.mode == PinMode::kAnalog;
        const auto event = document->find(analog ? "analog" : "digital");
        if (event == document->end() || !event->is_object()) return;
        const auto value = event->find(analog ? member.analog_channel : std::to_string(member.pin));
        if (value == event->end() || !value->is_number_integer()) return;
        member.reading.value = value->get<int>();
        member.wants_value = false;
        finish_if_answered(member);
    }

    bus::Reply reply_of(const Member& member) const {
        if (member.failed) return *member.failed;
        if (member.done) return bus::Reply{};
        if (session_.stopped()) return not_waited_for();
        auto reply = bus::Reply::timeout(bus::kTimeoutNoValue);
        reply.error = "the board reports no value of pin " + std::to_string(member.pin) + " now";
        return reply;
    }

    int report() {
        int status = program::kExitOk;
        std::size_t done = 0;
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"BOARD"}, {"PIN"}, {"MODE"}, {"VALUE"}, {"RESULT", false, 10}});
        for (const auto& member : members_) {
            const bool ok = member.done && !member.failed;
            const auto reply = reply_of(member);
            done += ok ? 1 : 0;
            if (!ok && status == program::kExitOk) status = exit_status(reply);
            auto why = ok ? std::string() : why_not(reply);
            if (reply.code != 0) why += why_taken(member.description, member.pin);
            const auto label = member.description.labels.pin(member.pin);
            if (!options_.output.for_people()) {
                records.print(record(member, ok, reply, why, label));
                continue;
            }
            table.add({member.name(),
                       std::to_string(member.pin) + (label.empty() ? "" : " " + for_terminal(label)),
                       ok ? std::string(protocol::to_text(member.reading.mode)) : "",
                       ok ? value_text(member.reading) : "",
                       ok ? Cell("ok", Colour::kGreen) : Cell(for_terminal(why), Colour::kRed)});
        }
        records.finish();
        if (options_.output.for_people())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        if (status != program::kExitOk)
            environment_.note(std::to_string(done) + " of " + std::to_string(members_.size()) +
                              (action_ ? " boards did it" : " boards answered"));
        return status;
    }

    static nlohmann::json record(const Member& member, bool ok, const bus::Reply& reply,
                                 const std::string& why, const std::string& label) {
        nlohmann::json object{{"board", member.name()}, {"pin", member.pin}};
        if (!label.empty()) object["label"] = label;
        object["status"] = ok ? "ok" : std::string(bus::to_string(reply.status));
        if (ok) {
            object["mode"] = protocol::to_text(member.reading.mode);
            if (member.reading.value) object["value"] = *member.reading.value;
            return object;
        }
        object["error"] = why;
        if (!reply.reason.empty()) object["reason"] = reply.reason;
        if (reply.code != 0) object["code"] = reply.code;
        return object;
    }

    const PinOptions& options_;
    Environment& environment_;
    BusSession& session_;
    std::optional<PinAction> action_;
    std::list<Member> members_;
};

}  // namespace

int run_pin_group(const PinOptions& options, const Target& target, const bus::LabelSelector& labels,
                  Environment& environment, BusSession& session, BoardSource& source) {
    if (options.pin.empty())
        return environment.fail_with({program::kExitUsage, "which pin of these boards? Write asipctl pin " +
                                                               options.board +
                                                               " PIN; asipctl get shows all values of many"});
    const auto boards = choose_boards(source, {target.board, kIo}, labels);
    if (!boards) return environment.fail_with(boards.error());
    return PinGroup(options, environment, session).run(*boards);
}

}  // namespace asip::cli
