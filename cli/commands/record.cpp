// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <set>

#include "cli/ask/bus_session.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/record/recording_file.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr std::string_view kStandardOutput = "-";

struct RecordOptions {
    std::string file;
    std::vector<std::string> targets;
    std::size_t count = 0;
    std::optional<std::chrono::milliseconds> limit{};
    bool replace = false;
    bool no_demand = false;
    OutputOptions output{};
};

/// Filters for all that boards say and are asked. What commands are answered is not among it: an answer
/// goes to its requester.
std::set<std::string> recorded_filters(const bus::Topics& topics, const std::vector<Target>& targets) {
    std::set<std::string> filters{topics.board_names()};
    for (const auto& target : targets) {
        const auto board = target.board.find_first_of("*?") == std::string::npos ? target.board : "+";
        filters.insert({topics.state(board), topics.description(board), topics.stats(board),
                        topics.log(board), topics.service_names(board), topics.service_out(board, "+"),
                        topics.service_error(board, "+"), topics.service_in(board, "+"),
                        topics.board_out(board), topics.board_in(board), topics.stop(board)});
    }
    return filters;
}

/// Whether one of `targets` asks for it: of one service its values, errors and commands, besides what
/// announces its board.
bool records(const std::vector<Target>& targets, const bus::TopicRef& topic, const std::string& payload) {
    const auto board = topic.kind == bus::TopicKind::kBoardNames ? std::string_view(payload) : topic.board;
    for (const auto& target : targets) {
        if (!target.matches(board, target.service)) continue;
        const bool raw = topic.kind == bus::TopicKind::kBoardOut || topic.kind == bus::TopicKind::kBoardIn;
        if (target.service.empty() || (topic.service.empty() ? !raw : target.matches(board, topic.service)))
            return true;
    }
    return false;
}

class Recorder {
  public:
    Recorder(const RecordOptions& options, std::vector<Target> targets, RecordingWriter writer,
             Environment& environment)
        : options_(options),
          targets_(std::move(targets)),
          writer_(std::move(writer)),
          environment_(environment),
          session_(environment) {}

    int run() {
        session_.tell_refused_subscriptions();
        for (const auto& filter : recorded_filters(environment_.topics, targets_))
            subscriptions_.push_back(
                session_.subscribe(filter, [this](const mqtt::Message& message) { take(message); }));
        for (const auto& target : targets_)
            if (!options_.no_demand) wants_.push_back(session_.want(target.board, target.service));
        session_.on_connection_change([this](bool connected, const std::string& why) {
            environment_.note(connected ? "connected again; messages between are missing" : why);
            if (!connected) writer_.text() += gap_line(elapsed(), why);
        });
        writer_.text() += recording_header(text::wall_now());
        begin_ = Clock::now();
        if (const auto connected = session_.connect(); !connected) {
            writer_.discard();
            return environment_.fail_with(connected.error());
        }
        const auto deadline = options_.limit ? Clock::now() + *options_.limit : Time::max();
        const auto ended = [this] {
            if (!fault_.empty()) return true;
            if (const auto written = writer_.flush_due(Clock::now()); !written) fault_ = written.error();
            return !fault_.empty() || enough();
        };
        while (!session_.stopped() && !ended() && Clock::now() < deadline)
            session_.run_until(ended, std::min(deadline, Clock::now() + 1h));
        if (fault_.empty())
            if (const auto written = writer_.flush(); !written) fault_ = written.error();
        if (to_output() && environment_.reader_gone()) fault_.clear();  // it has read what it wanted
        return finish();
    }

  private:
    std::chrono::microseconds elapsed() const {
        return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin_);
    }
    bool to_output() const { return options_.file == kStandardOutput; }
    bool enough() const { return options_.count != 0 && messages_ >= options_.count; }

    void take(const mqtt::Message& message) {
        if (enough()) return;
        const auto topic = environment_.topics.parse(message.topic);
        if (!topic || !is_recorded(topic->kind) || !records(targets_, *topic, message.payload)) return;
        append_recorded(writer_.text(), *topic, message, elapsed());
        if (!topic->board.empty() && boards_.find(topic->board) == boards_.end())
            boards_.emplace(topic->board);
        ++messages_;
    }

    int finish() {
        const double seconds = std::chrono::duration<double>(elapsed()).count();
        const auto tenths = static_cast<long>(seconds * 10);
        if (to_output()) {
            environment_.note(summary(tenths));
        } else if (!options_.output.for_people()) {
            RecordPrinter(options_.output, RecordPrinter::Count::kOne, environment_.out)
                .print({{"file", options_.file},
                        {"messages", messages_},
                        {"boards", boards_.size()},
                        {"bytes", writer_.bytes()},
                        {"seconds", static_cast<double>(tenths) / 10}});
        } else {
            environment_.out << summary(tenths) << std::endl;
        }
        if (!fault_.empty()) return environment_.fail_with({program::kExitFailure, fault_});
        const bool too_few =
            options_.limit && !session_.stopped() && messages_ < std::max<std::size_t>(1, options_.count);
        return too_few ? program::kExitNoAnswer : program::kExitOk;
    }

    std::string summary(long tenths) const {
        return counted(messages_, "message") + " of " + counted(boards_.size(), "board") + " in " +
               std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10) + " s";
    }

    const RecordOptions& options_;
    std::vector<Target> targets_;
    RecordingWriter writer_;
    Environment& environment_;
    BusSession session_;
    std::vector<BusSession::Subscription> subscriptions_;
    std::vector<bus::Demander::Want> wants_;
    Time begin_{};
    std::size_t messages_ = 0;
    std::set<std::string, std::less<>> boards_;
    std::string fault_;
};

int run_record(const RecordOptions& options, Environment& environment) {
    std::vector<Target> targets;
    for (const auto& text : options.targets) {
        auto target = parse_target(text, true);
        if (!target) return environment.fail_with(target.error());
        targets.push_back(std::move(*target));
    }
    if (targets.empty()) targets.push_back({"*", ""});
    if (options.file == kStandardOutput && !options.output.for_people())
        return environment.fail_with(
            {program::kExitUsage,
             "with \"-\" the recording itself is the output; leave -o and --format away"});
    auto writer = RecordingWriter::create(options.file, options.replace);
    if (!writer) return environment.fail_with(writer.error());
    return Recorder(options, std::move(targets), std::move(*writer), environment).run();
}

Run declare_record(Declaration& verb) {
    auto options = std::make_shared<RecordOptions>();
    verb.argument("FILE", options->file, "Where to; a new file, or - for standard output");
    verb.arguments("BOARD[/SERVICE]", options->targets, "What; with * and ? as in a shell; default: all",
                   Declaration::Needed::kNo);
    verb.option("-n,--count", "COUNT", options->count, "End after so many messages; 0: no limit");
    verb.option("-W,--for", options->limit,
                "End after this time; status 4 when nothing (or less than -n) came");
    verb.flag("--replace", options->replace, "Write over a file that exists");
    verb.flag("--no-demand", options->no_demand, "Only listen: ask no board to report");
    verb.output(options->output, {Output::kText}, {"file", "messages", "boards", "bytes", "seconds"});
    return [options](Environment& environment) { return run_record(*options, environment); };
}

}  // namespace

Verb record_verb() {
    return {
        "record", "Writes what boards say and are asked to a file",
        "Each message is a line of JSON, with the time since the beginning in seconds. It is in the file\n"
        "within a second, whatever ends the program. Ctrl-C ends it in order. asipctl replay plays it.\n"
        "With - the lines go to standard output, and what was recorded is told on standard error.\n"
        "Examples:\n"
        "  asipctl record walk.jsonl\n"
        "  asipctl record - uno1 | jq .\n"
        "  asipctl record walk.jsonl 'robot*' -W 10m\n"
        "  asipctl record walk.jsonl uno1/distance && jq 'select(.what==\"value\").data' walk.jsonl",
        declare_record};
}

}  // namespace asip::cli
