// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/pin.hpp"

#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/protocol/body.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/board_values.hpp"
#include "cli/commands/show.hpp"
#include "cli/declaration.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using protocol::PinMode;

/// The pins of one board, through its io service.
class PinAccess {
  public:
    PinAccess(Environment& environment, BusSession& session, KnownBoard board)
        : environment_(environment), session_(session), board_(std::move(board)) {}

    Outcome<std::vector<PinMode>> modes() {
        auto answer = request("p");
        if (!answer) return tl::unexpected(answer.error());
        return modes_of(answer->answer);
    }

    Outcome<bus::Reply> request(const std::string& text) {
        const auto& name = board_.item.board;
        auto reply =
            ask_board(session_, {.topic = environment_.topics.service_in(name, service_), .payload = text});
        if (!reply) return reply;
        if (!reply->succeeded()) return tl::unexpected(failure_of(*reply, "I," + text + ": "));
        return reply;
    }

    Outcome<PinReading> read(int pin, PinMode mode) {
        PinReading result{mode, std::nullopt};
        if (protocol::is_digital_input(mode)) return read_level(pin, result);
        if (mode == PinMode::kAnalog) return read_analog(pin, result);
        if (mode == PinMode::kOutput || mode == PinMode::kPwm) {
            const BoardValues values(environment_, session_, board_, service_);
            session_.run_until([&] { return values.answered(); }, Clock::now() + environment_.timeout);
            result.value = values.raw_set("io/" + std::to_string(pin));
        }
        return result;
    }

    const KnownBoard& board() const { return board_; }
    /// Values start to arrive; before the requests that cause them.
    void listen() {
        reports_ = session_.subscribe(environment_.topics.service_out(board_.item.board, service_),
                                      [this](const mqtt::Message& message) {
                                          if (message.retain) return;
                                          auto document = model::parse_json(message.payload);
                                          if (!document || !document->is_object()) return;
                                          for (const auto& [name, value] : document->items())
                                              if (value.is_object()) latest_[name].update(value);
                                      });
    }

  private:
    std::optional<int> latest(const std::string& event, const std::string& key) const {
        const auto found = latest_.find(event);
        if (found == latest_.end() || !found->second.contains(key) || !found->second[key].is_number_integer())
            return std::nullopt;
        return found->second[key].get<int>();
    }

    /// The agent knows it; nothing is set to learn it.
    Outcome<PinReading> read_level(int pin, PinReading result) {
        const auto key = std::to_string(pin);
        const BoardValues values(environment_, session_, board_, service_);
        session_.run_until([&] { return values.answered() || latest("digital", key); },
                           Clock::now() + environment_.timeout);
        result.value = values.answered() ? pin_value(values.pins(), "digital", pin) : latest("digital", key);
        if (result.value) return result;
        if (!values.answered())
            return tl::unexpected(session_.unanswered("the board's agent does not answer; does it run?"));
        return failure(program::kExitNoAnswer, "the level of pin " + key +
                                                   " is not known yet: the board tells it when it changes, "
                                                   "and when its mode is set (asipctl pin " +
                                                   board_.item.board + " " + key + " " +
                                                   (result.mode == PinMode::kInput ? "input" : "pullup") +
                                                   ")");
    }

    Outcome<PinReading> read_analog(int pin, PinReading result) {
        std::optional<int> channel;
        if (board_.description) {
            for (const auto& [digital, number] : board_.description->pins.analog)
                if (digital == pin) channel = number;
        }
        if (!channel)
            return failure(program::kExitFailure, "the board did not report which analog channel pin " +
                                                      std::to_string(pin) + " is");
        const auto key = std::to_string(*channel);
        const auto demand = session_.demand(board_.item.board, service_);
        const auto patience = std::min<Duration>(environment_.timeout, std::chrono::seconds(2));
        session_.run_until([&] { return latest("analog", key).has_value(); }, Clock::now() + patience);
        result.value = latest("analog", key);
        if (!result.value) {
            return tl::unexpected(
                session_.unanswered("the board reports no analog values now; start it: asipctl send " +
                                    board_.item.board + "/" + service_ + " report 50"));
        }
        return result;
    }

    Environment& environment_;
    BusSession& session_;
    BusSession::Subscription reports_;
    KnownBoard board_;
    std::string service_ = "io";
    std::map<std::string, nlohmann::json> latest_;
};

void print(const PinOptions& options, Environment& environment, int pin, const PinReading& reading,
           const std::string& label) {
    const auto mode = protocol::to_text(reading.mode);
    if (!options.output.for_people()) {
        nlohmann::json record{{"board", options.board}, {"pin", pin}, {"mode", mode}};
        if (reading.value) record["value"] = *reading.value;
        if (!label.empty()) record["label"] = label;
        RecordPrinter(options.output, RecordPrinter::Count::kOne, environment.out).print(record);
        return;
    }
    environment.out << pin << ' ' << mode;
    if (reading.value) environment.out << ' ' << value_text(reading);
    if (!label.empty()) environment.out << "  " << for_terminal(label);
    environment.out << std::endl;
}

Outcome<void> act(const PinOptions& options, Environment& environment, PinAccess& access) {
    const auto description = access.board().description.value_or(model::Description());
    const auto pin = find_pin(options.pin, description);
    if (!pin) return tl::unexpected(pin.error());
    const auto label = description.labels.pin(*pin);
    const auto modes = access.modes();
    if (!modes) return tl::unexpected(modes.error());
    if (static_cast<std::size_t>(*pin) >= modes->size()) {
        return failure(program::kExitUsage,
                       options.board + " has pins 0 to " + std::to_string(modes->size() - 1));
    }
    const auto mode = (*modes)[static_cast<std::size_t>(*pin)];
    if (options.word.empty()) {
        const auto reading = access.read(*pin, mode);
        if (!reading) return tl::unexpected(reading.error());
        print(options, environment, *pin, *reading, label);
        return {};
    }
    auto action = parse_pin_word(options.word);
    if (!action) return tl::unexpected(action.error());
    if (action->kind == PinAction::Kind::kToggle) {
        const auto present =
            mode == PinMode::kOutput ? access.read(*pin, mode) : PinReading{mode, std::nullopt};
        if (!present) return tl::unexpected(present.error());
        if (!present->value)
            return failure(program::kExitNoAnswer, "it is not known whether pin " + std::to_string(*pin) +
                                                       " is high: nothing was set on it; write high or low");
        *action = {PinAction::Kind::kWrite, PinMode::kOutput, *present->value == 0 ? 1 : 0};
    }
    for (const auto& request : pin_requests(*pin, *action, mode)) {
        if (auto done = access.request(request); !done) {
            if (access.board().description) done.error().text += why_taken(*access.board().description, *pin);
            return tl::unexpected(std::move(done.error()));
        }
    }
    const bool level = action->kind == PinAction::Kind::kWrite;
    print(options, environment, *pin,
          {action->mode, level ? std::optional<int>(action->value) : std::nullopt}, label);
    return {};
}

Outcome<void> show_pins(const PinOptions& options, Environment& environment, const KnownBoard& board,
                        PinAccess& access) {
    if (!board.description)
        return failure(program::kExitFailure, board.item.board + " " + board.why_no_description());
    auto description = *board.description;
    if (const auto modes = access.modes()) {
        description.pins.modes.clear();
        for (const auto mode : *modes)
            description.pins.modes += static_cast<char>('0' + static_cast<int>(mode));
    }
    if (options.output.for_people()) {
        environment.out << pins_text(description, environment.width, environment.colour) << std::flush;
        return {};
    }
    RecordPrinter records(options.output, RecordPrinter::Count::kList, environment.out);
    for (const auto& record : pin_records(description))
        records.print(record);
    records.finish();
    return {};
}

Outcome<void> run_on_board(const PinOptions& options, Environment& environment, BusSession& session,
                           BoardSource& source) {
    auto board = find_living_board(source, options.board);
    if (!board) return tl::unexpected(board.error());
    if (const auto io = find_service(*board, "io"); !io) return tl::unexpected(io.error());
    PinAccess access(environment, session, *board);
    access.listen();
    return options.pin.empty() ? show_pins(options, environment, *board, access)
                               : act(options, environment, access);
}

}  // namespace

int run_pin(PinOptions options, Environment& environment) {
    if (!options.duty.empty()) {
        if (options.word != "pwm" || !protocol::parse_integer(options.duty))
            return environment.fail_with(
                {program::kExitUsage, "'" + options.word + "' takes no '" + options.duty +
                                          "'; a duty from 0 to 255 stands alone or behind pwm"});
        options.word = std::exchange(options.duty, {});
    }
    const auto target = parse_target(options.board, true);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with(
            {program::kExitUsage, "pin takes a board, not a service: asipctl pin " + target->board + " ..."});
    if (target->is_pattern())
        return environment.fail_with(
            {program::kExitUsage, "pin takes one board; several are commanded by asipctl send '" +
                                      target->board + "/io' write PIN 1"});
    if (!options.word.empty()) {
        if (const auto action = parse_pin_word(options.word); !action)
            return environment.fail_with(action.error());
    }
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    const auto done = run_on_board(options, environment, session, source);
    if (done) return program::kExitOk;
    const auto count = options.pin.empty() ? RecordPrinter::Count::kList : RecordPrinter::Count::kOne;
    print_failure(options.output, count, options.board, done.error(), environment.out);
    return environment.fail_with(done.error());
}

namespace {

Run declare_pin(Declaration& verb) {
    auto options = std::make_shared<PinOptions>();
    verb.argument("BOARD", options->board, "Name of the board");
    verb.argument("PIN", options->pin, "13, D13, A0 or its name; without it all pins are shown",
                  Declaration::Needed::kNo);
    verb.argument("high|low|toggle|input|pullup|output|analog|pwm|...", options->word,
                  "What to set, or 0..255 for PWM; without it the pin is read", Declaration::Needed::kNo);
    verb.argument("DUTY", options->duty, "Behind pwm: 0..255", Declaration::Needed::kNo);
    verb.output(options->output, {Output::kText},
                {"board", "pin", "mode", "value", "owner", "can", "channel", "label", "status", "error",
                 "reason", "code"});
    return [options](Environment& environment) { return run_pin(*options, environment); };
}

}  // namespace

Verb pin_verb() {
    return {"pin", "Read or set a pin in words",
            "Sets the mode that the word needs: high and low make an output, 0..255 makes PWM.\n"
            "Several boards: asipctl send 'PATTERN/io' write PIN 1.\n"
            "Examples:\n"
            "  asipctl pin uno1 13 high\n"
            "  asipctl pin uno1 13 toggle\n"
            "  asipctl pin uno1 3 128\n"
            "  asipctl pin uno1 3 pwm 128\n"
            "  asipctl pin uno1 2 pullup\n"
            "  asipctl pin uno1 2\n"
            "  asipctl pin uno1 A0\n"
            "  asipctl pin uno1 \"status lamp\" high",
            declare_pin};
}

}  // namespace asip::cli
