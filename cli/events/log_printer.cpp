// SPDX-License-Identifier: Apache-2.0
#include "cli/events/log_printer.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/pattern.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/events/log_line.hpp"
#include "cli/find/target.hpp"
#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

Colour colour_of(const std::string& level) {
    if (level == "error") return Colour::kRed;
    return level == "warning" ? Colour::kYellow : Colour::kNone;
}

class LogPrinter {
  public:
    LogPrinter(const LogOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          records_(options.output, RecordPrinter::Count::kStream, environment.out) {}

    void take(const mqtt::Message& message) {
        const auto line = log_line(environment_.topics, message);
        if (!line || enough() || !bus::matches_pattern(options_.pattern, line->board)) return;
        ++count_;
        const auto time = text::iso_time(text::wall_now());
        if (!options_.output.for_people())
            return records_.print({{"time", time},
                                   {"board", line->board},
                                   {"source", line->source},
                                   {"level", line->level},
                                   {"text", line->text}});
        const auto where = line->board + (line->source == "board" ? "" : "/" + line->source);
        environment_.out << time << "  " << where << "  "
                         << painted(for_terminal(line->text), colour_of(line->level), environment_.colour)
                         << std::endl;
    }
    bool enough() const { return options_.count != 0 && count_ >= options_.count; }
    std::size_t count() const { return count_; }

  private:
    const LogOptions& options_;
    Environment& environment_;
    RecordPrinter records_;
    std::size_t count_ = 0;
};

}  // namespace

int run_logs(const LogOptions& options, Environment& environment) {
    if (const auto valid = check_board_pattern(options.pattern, "events"); !valid)
        return environment.fail_with(valid.error());
    BusSession session(environment);
    session.tell_refused_subscriptions();
    LogPrinter printer(options, environment);
    const auto take = [&printer](const mqtt::Message& message) { printer.take(message); };
    // Levels of a topic know no patterns but "+".
    const bool one = options.pattern.find_first_of("*?") == std::string::npos;
    const std::string board = one ? options.pattern : "+";
    std::vector<BusSession::Subscription> subscriptions;
    for (const auto& filter : {environment.topics.board_out(board),
                               environment.topics.service_error(board, "+"), environment.topics.log(board)})
        subscriptions.push_back(session.subscribe(filter, take, {.retained = false}));
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    const auto end = options.limit ? Clock::now() + *options.limit : Time::max();
    while (!session.stopped() && !printer.enough() && Clock::now() < end)
        session.run_until([&] { return printer.enough(); },
                          std::min(end, Clock::now() + std::chrono::hours(1)));
    const bool too_few = options.limit && !session.stopped() && printer.count() < options.count;
    return too_few ? program::kExitNoAnswer : program::kExitOk;
}

}  // namespace asip::cli
