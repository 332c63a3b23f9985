// SPDX-License-Identifier: Apache-2.0
#include <boost/asio/io_context.hpp>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/pattern.hpp"
#include "asip/model/names.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/quirks/closes_when_denied.hpp"
#include "asip/program/options.hpp"
#include "asip/program/stop_signal.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/declaration.hpp"
#include "cli/record/recording_file.hpp"
#include "cli/record/replay_board.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxReplayBoards = 1000;
constexpr Duration kClaimPatience = 10s;
constexpr Duration kGoodbyePatience = 1s;
/// For what was played last: until the broker has it, or denies it.
constexpr Duration kArrivalPatience = 30s;
/// So much may wait for the broker before the reading waits, too.
constexpr std::size_t kMaxWaiting = 1000;
constexpr std::size_t kPlayedAtOnce = 200;

struct ReplayOptions {
    std::string file;
    std::vector<std::string> patterns;
    std::string prefix;
    std::string credentials_dir;  ///< NAME.credentials of each board; empty: all use those of asipctl
    double speed = 1;
    bool loop = false;
    OutputOptions output{};

    bool wants(const std::string& board) const {
        return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&board](const auto& one) {
                   return bus::matches_pattern(one, board);
               });
    }
};

using RecordedBoards = std::map<std::string, ReplayBoard::Recorded>;

Outcome<RecordedBoards> recorded_boards(const ReplayOptions& options) {
    auto reader = RecordingReader::open(options.file);
    if (!reader) return tl::unexpected(reader.error());
    RecordedBoards boards;
    while (true) {
        const auto message = reader->next();
        if (!message) return tl::unexpected(message.error());
        if (!*message) break;
        if (options.wants((*message)->board)) boards[(*message)->board].take(**message);
    }
    if (boards.empty())
        return failure(program::kExitFailure,
                       options.file + (options.patterns.empty() ? ": no board was recorded"
                                                                : ": no such board was recorded"));
    if (boards.size() > kMaxReplayBoards)
        return failure(
            program::kExitFailure,
            options.file + ": more than " + std::to_string(kMaxReplayBoards) + " boards; name some of them");
    for (const auto& [name, recorded] : boards) {
        if (!model::valid_board_name(options.prefix + name))
            return failure(program::kExitUsage,
                           "--prefix: " + model::explain_board_name(options.prefix + name));
    }
    return boards;
}

/// How the board `name` connects. Fails with kExitUsage.
Outcome<mqtt::Options> connection_of(const std::string& name, const ReplayOptions& options,
                                     Environment& environment) {
    if (options.credentials_dir.empty()) return environment.mqtt;
    program::BrokerOptions own;
    const auto file = std::filesystem::path(options.credentials_dir) / (name + ".credentials");
    if (std::error_code error; !std::filesystem::exists(file, error))
        return failure(
            program::kExitUsage,
            file.string() +
                " does not exist; the administrator of the broker makes it: asipctl secure add board " +
                name + ", or leave this board out");
    if (const auto taken = program::take_credentials(own, file.string()); !taken)
        return failure(program::kExitUsage, taken.error());
    auto result = program::mqtt_options(own, "asipctl");
    if (!result) return failure(program::kExitUsage, file.string() + ": " + result.error());
    result->connect_timeout = environment.mqtt.connect_timeout;
    environment.topics = bus::Topics(own.topic_root);
    return std::move(*result);
}

/// What the user is missing, where the broker's access rules deny a board.
std::string denied_board(const std::string& user, const std::string& name) {
    return "the broker's access rules deny " + (user.empty() ? "users without a name" : "user " + user) +
           " to speak for board " + name +
           ": a recorded board needs credentials as every board does. The "
           "administrator of the broker makes them: asipctl secure add board " +
           name + "; then --credentials " + name +
           ".credentials, or --credentials-dir FOLDER for several boards";
}

struct PlayerEvents {
    std::function<void(const std::string& why)> fatal;
    std::function<void(const std::string& why)> lost;  ///< the connection that was established
    std::function<void()> back;
};

/// One recorded board with its connection.
class Player {
  public:
    Player(boost::asio::io_context& io, const bus::Topics& topics, mqtt::Options options, ReplayBoard board,
           PlayerEvents events)
        : topics_(topics),
          has_user_(options.has_user()),
          board_(std::move(board)),
          user_(options.user),
          events_(std::move(events)) {
        options.will = board_.will();
        client_ = std::make_unique<mqtt::Client>(io, std::move(options), handlers());
        for (auto& [filter, how] : board_.subscriptions())
            client_->subscribe(std::move(filter), how);
        client_->start();
    }

    /// Announced, and every subscription granted: until then a broker that denies this board has not said so.
    bool ready() const { return subscribed_ && board_.ready(); }
    bool keeps_up() const { return client_->counters().queued < kMaxWaiting; }
    /// Whether the broker has, or has denied, all that was published.
    bool arrived() const {
        const auto counters = client_->counters();
        return ready() && counters.queued == 0 && counters.unacknowledged == 0;
    }
    void tick() {
        with([this](Time now, auto& out) { board_.tick(now, out); });
    }
    void play(const RecordedMessage& message) {
        with([&](Time now, auto& out) { board_.play(message, now, out); });
    }
    void end(std::function<void()> ended) {
        with([this](Time now, auto& out) { board_.goodbye(now, out); });
        client_->stop(kGoodbyePatience, std::move(ended));
    }

  private:
    template <class Call>
    void with(Call&& call) {
        member::Announcements out;
        call(Clock::now(), out);
        if (has_user_) member::take_stray_answers(out.publish, topics_, board_.name());
        for (auto& publication : out.publish)
            client_->publish(std::move(publication.message), publication.priority);
        if (out.fatal)
            events_.fatal(out.fatal->text.substr(0, out.fatal->text.find(';')) +
                          "; replay under other names: --prefix old-");
    }

    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_connected = [this](const mqtt::Connected&) {
            if (std::exchange(lost_, false)) events_.back();
            client_->discard_queued(mqtt::Priority::kAnnouncement);
            with([this](Time now, auto& out) { board_.on_connected(now, out); });
        };
        result.on_subscribed = [this] {
            subscribed_ = true;
            with([this](Time now, auto& out) { board_.on_subscribed(now, out); });
        };
        result.on_disconnected = [this](const mqtt::ConnectionFailure& why) {
            // Older brokers close the connection over what they deny.
            if (why.after_sending >= mqtt::ClosesWhenDenied::kTimes)
                events_.fatal(denied_board(user_, board_.name()));
            lost_ = true;
            events_.lost(why.text);
            subscribed_ = false;
            board_.on_disconnected();
        };
        result.on_publish_denied = [this](const std::string&, const std::string&) {
            events_.fatal(denied_board(user_, board_.name()));
        };
        result.on_subscribe_refused = [this](const std::string&, const std::string&) {
            events_.fatal(denied_board(user_, board_.name()));
        };
        result.on_connect_failed = [this](const mqtt::ConnectionFailure& why) {
            if (why.hopeless) events_.fatal(why.text);
        };
        result.on_message = [this](const mqtt::Message& message) {
            with([&](Time now, auto& out) { board_.on_message(message, now, out); });
        };
        return result;
    }

    bus::Topics topics_;
    bool has_user_ = false;
    ReplayBoard board_;
    std::string user_;
    PlayerEvents events_;
    bool subscribed_ = false;
    bool lost_ = false;
    std::unique_ptr<mqtt::Client> client_;
};

class Replayer {
  public:
    Replayer(const ReplayOptions& options, Environment& environment)
        : options_(options), environment_(environment), signal_(io_, [this](int) { stopped_ = true; }) {}

    int run(const RecordedBoards& boards) {
        if (const auto made = make_players(boards); !made) return environment_.fail_with(made.error());
        if (!run_until([this] { return all_ready(); }, Clock::now() + kClaimPatience) && fatal_.empty() &&
            !stopped_)
            fail_late("the boards could not be announced within 10 s; may this user write below " +
                      environment_.topics.root() + "/servicebus?");
        if (fatal_.empty() && !stopped_)
            environment_.note("replaying " + counted(players_.size(), "board") + "; Ctrl-C ends it");
        do {
            if (!play_once()) break;
        } while (options_.loop && messages_ > 0);
        wait_for_arrival();
        end_all();
        if (!fatal_.empty()) return environment_.fail_with({status_, fatal_});
        report();
        return program::kExitOk;
    }

  private:
    Outcome<void> make_players(const RecordedBoards& boards) {
        const auto source = std::filesystem::path(options_.file).filename().string();
        std::map<std::string, mqtt::Options> connections;
        for (const auto& [name, recorded] : boards) {
            auto connection = connection_of(options_.prefix + name, options_, environment_);
            if (!connection) return tl::unexpected(connection.error());
            connection->client_id += "-" + std::to_string(connections.size() + 1);
            connections.emplace(name, std::move(*connection));
        }
        for (const auto& [name, recorded] : boards) {
            auto& connection = connections.at(name);
            ReplayBoard::Identity identity{options_.prefix + name, source, {}, {}};
            identity.announcer.started_unix = static_cast<std::uint64_t>(std::time(nullptr));
            identity.announcer.on_shared_topic = !connection.has_user();
            identity.agent = {ASIP_VERSION, program::host_name(), connection.client_id};
            ReplayBoard board(environment_.topics, std::move(identity), recorded, environment_.mqtt.random);
            players_.emplace(name, std::make_unique<Player>(io_, environment_.topics, std::move(connection),
                                                            std::move(board), events()));
        }
        return {};
    }

    bool all_ready() const {
        return std::all_of(players_.begin(), players_.end(),
                           [](const auto& one) { return one.second->ready(); });
    }

    bool run_until(const std::function<bool()>& done, Time deadline) {
        while (!done()) {
            if (environment_.output_ended()) stopped_ = true;
            const auto left = deadline - Clock::now();
            if (stopped_ || !fatal_.empty() || left <= Duration::zero()) return false;
            io_.run_one_for(std::min<Duration>(left, 10ms));
            for (auto& [name, player] : players_)
                player->tick();
        }
        return true;
    }

    /// False: it was stopped, or failed.
    bool play_once() {
        auto reader = RecordingReader::open(options_.file);
        const auto begin = Clock::now();
        std::size_t since_turn = 0;
        while (reader && fatal_.empty() && !stopped_) {
            auto message = reader->next();
            if (!message) fatal_ = message.error().text;
            if (!message || !*message) return fatal_.empty();
            const auto player = players_.find((*message)->board);
            if (player == players_.end()) continue;
            const auto due = begin + std::chrono::duration_cast<Duration>((*message)->at / options_.speed);
            const bool wait =
                due > Clock::now() || ++since_turn >= kPlayedAtOnce || !player->second->keeps_up();
            if (wait) {
                since_turn = 0;
                run_until(
                    [&] {
                        return due <= Clock::now() && player->second->keeps_up() && player->second->ready();
                    },
                    Time::max());
            }
            if (stopped_ || !fatal_.empty()) return false;
            player->second->play(**message);
            ++messages_;
            played_ = std::max(played_, (*message)->at);
        }
        if (!reader) fatal_ = reader.error().text;
        return false;
    }

    void wait_for_arrival() {
        const auto all_arrived = [this] {
            return std::all_of(players_.begin(), players_.end(),
                               [](const auto& one) { return one.second->arrived(); });
        };
        if (run_until(all_arrived, Clock::now() + kArrivalPatience) || stopped_ || !fatal_.empty()) return;
        fail_late("the broker did not take all within 30 s; what was played last may be missing");
    }

    void fail_late(const std::string& why) {
        fatal_ = lost_ == 0 ? why : why_lost_ + ", and was not back in time";
        if (lost_ != 0) status_ = program::kExitBroker;
    }

    /// All have the same broker, which is told of once.
    PlayerEvents events() {
        return {[this](const std::string& why) {
                    if (fatal_.empty()) fatal_ = why;
                },
                [this](const std::string& why) {
                    if (lost_++ == 0) environment_.note(why_lost_ = why);
                },
                [this] {
                    if (--lost_ == 0) environment_.note("connected again");
                }};
    }

    void end_all() {
        std::size_t open = players_.size();
        for (auto& [name, player] : players_)
            player->end([&open] { --open; });
        const auto deadline = Clock::now() + 2 * kGoodbyePatience;
        while (open > 0 && Clock::now() < deadline)
            io_.run_one_for(10ms);
        signal_.cancel();
    }

    void report() {
        const double seconds = std::chrono::duration<double>(played_).count();
        if (!options_.output.for_people()) {
            RecordPrinter(options_.output, RecordPrinter::Count::kOne, environment_.out)
                .print({{"file", options_.file},
                        {"messages", messages_},
                        {"boards", players_.size()},
                        {"seconds", seconds}});
            return;
        }
        environment_.out << counted(messages_, "message") << " of " << counted(players_.size(), "board")
                         << std::endl;
    }

    const ReplayOptions& options_;
    Environment& environment_;
    boost::asio::io_context io_{1};
    bool stopped_ = false;
    std::string fatal_, why_lost_;
    int status_ = program::kExitFailure;  // where it is fatal
    std::size_t lost_ = 0;                // players without a connection
    program::StopSignal signal_;
    std::map<std::string, std::unique_ptr<Player>> players_;
    std::size_t messages_ = 0;
    std::chrono::microseconds played_{};
};

int run_replay(const ReplayOptions& options, Environment& environment) {
    const auto boards = recorded_boards(options);
    if (!boards) return environment.fail_with(boards.error());
    // Says what is wrong with the broker, once for all boards.
    Environment first = environment;
    auto connection = connection_of(options.prefix + boards->begin()->first, options, first);
    if (!connection) return environment.fail_with(connection.error());
    first.mqtt = std::move(*connection);
    {
        BusSession session(first);
        if (const auto connected = session.connect(); !connected)
            return environment.fail_with(connected.error());
    }
    return Replayer(options, environment).run(*boards);
}

Run declare_replay(Declaration& verb) {
    auto options = std::make_shared<ReplayOptions>();
    verb.argument("FILE", options->file, "A recording, by asipctl record");
    verb.arguments("PATTERN", options->patterns, "Only these boards of it; * and ? as in a shell",
                   Declaration::Needed::kNo);
    verb.option("--speed", "FACTOR", options->speed, "How much faster than it was", 0.01, 1000);
    verb.option("--prefix", "TEXT", options->prefix, "Before the name of each board, for a bus that has it");
    verb.option("--credentials-dir", "DIR", options->credentials_dir,
                "On a secured bus: folder with the credentials of each board, NAME.credentials");
    verb.flag("--loop", options->loop, "Begin again at the end, until Ctrl-C");
    verb.output(options->output, {Output::kText}, {"file", "messages", "boards", "seconds"});
    return [options](Environment& environment) { return run_replay(*options, environment); };
}

}  // namespace

Verb replay_verb() {
    return {
        "replay", "Plays a recording onto the bus, as boards of its own",
        "Each recorded board is a member as others are: announced, with a lease and a state, and lost when\n"
        "this program dies. It refuses commands. A name that a living board has is refused. On a secured "
        "bus\n"
        "each needs credentials of its own: asipctl secure add board NAME.\n"
        "Examples:\n"
        "  asipctl replay walk.jsonl\n"
        "  asipctl replay walk.jsonl 'robot*' --speed 10 --prefix old-\n"
        "  asipctl replay walk.jsonl --loop --broker 127.0.0.1:1884\n"
        "  asipctl replay walk.jsonl --prefix old- --credentials-dir ~/recorded",
        declare_replay};
}

}  // namespace asip::cli
