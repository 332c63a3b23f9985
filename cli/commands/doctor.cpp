// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <list>
#include <ostream>

#include "asip/protocol/request.hpp"
#include "asip/random.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/doctor/agents.hpp"
#include "cli/doctor/findings.hpp"
#include "cli/environment.hpp"
#include "cli/output.hpp"
#include "cli/secure/try_out.hpp"
#include "cli/text/samples.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

struct DoctorOptions {
    bool agents = false;  ///< list what they counted instead
    OutputOptions output{};
};

constexpr int kWarmUps = 20;
constexpr int kRoundTrips = 9;
constexpr std::size_t kMaxOpenPings = 200;

/// Gathers what the checks judge.
class Examination {
  public:
    Examination(Environment& environment, BusSession& session, BoardSource& source)
        : environment_(environment), session_(session), source_(source) {
        seen_.topics = environment.topics;
        seen_.broker = environment.mqtt.brokers.front().describe();
    }

    Outcome<Observations> look() {
        seen_.v5 = session_.v5();
        seen_.max_packet_bytes = session_.max_packet_bytes();
        try_without_user();
        measure_acknowledgement();
        auto retained = read_retained(environment_, session_, {environment_.topics.root() + "/#"});
        if (!retained) return tl::unexpected(retained.error());
        seen_.retained = std::move(*retained);
        const auto others = read_retained(environment_, session_, {"homeassistant/#"});
        if (!others) return tl::unexpected(others.error());
        seen_.home_assistant = !others->empty();
        watch_sessions();
        source_.read_bus(true);
        ask_registry();
        ping_boards();
        if (const auto heard = session_.heard_all(); !heard) return tl::unexpected(heard.error());
        seen_.machine = look_at_machine();
        return std::move(seen_);
    }

  private:
    void measure_acknowledgement() {
        const auto client = "doctor-" + std::to_string(Clock::now().time_since_epoch().count());
        const auto topic = bus::ReplyTopics(environment_.topics, environment_.mqtt.user, client).own();
        bool back = false;
        // QoS 0 back: an acknowledgement of ours would carry the TCP acknowledgement that Nagle's algorithm
        // waits for.
        const auto subscription = session_.subscribe(topic, [&back](const mqtt::Message&) { back = true; },
                                                     {.qos = 0, .no_local = false, .retained = false});
        const auto end = Clock::now() + 2s;
        Samples seconds;  // without the first ones: a fresh connection acknowledges at once
        for (int i = 0; i < kWarmUps + kRoundTrips; ++i) {
            back = false;
            const auto before = session_.acknowledged();
            const auto begin = Clock::now();
            session_.publish(topic, "round", 1);
            if (!session_.run_until([&] { return back && session_.acknowledged() > before; }, end)) break;
            if (i >= kWarmUps) seconds.add(std::chrono::duration<double>(Clock::now() - begin).count());
        }
        if (!seconds.empty()) seen_.acknowledged = std::chrono::duration<double>(seconds.percentile(50));
    }

    void try_without_user() {
        const auto& brokers = environment_.mqtt.brokers;
        seen_.loopback = std::all_of(brokers.begin(), brokers.end(), [](const auto& broker) {
            return broker.host == "localhost" || broker.host == "::1" || broker.host.starts_with("127.");
        });
        const auto stranger = "asip-check-" + random_hex(system_random(), 12);
        if (const auto open =
                is_open(environment_.mqtt, environment_.topics.root(), stranger, environment_.timeout))
            seen_.open = *open;
    }

    void watch_sessions() {
        // Two live agents with one name both announce within the probe's window.
        source_.on_announcement([this](const std::string& board, const std::string& session) {
            seen_.sessions[board].insert(session);
        });
    }

    void ask_registry() {
        for (const auto& message : seen_.retained) {
            const auto ref = environment_.topics.parse(message.topic);
            const bool online =
                ref && ref->kind == bus::TopicKind::kRegistryState && message.payload == "online";
            if (online) seen_.registries.emplace_back(ref->board);
        }
        // The nodes of a cluster may not have what registries retain.
        if (!environment_.from_bus && (!seen_.registries.empty() || !source_.find_registry(false).empty())) {
            seen_.asked = std::chrono::system_clock::now();
            if (auto boards = source_.boards({})) seen_.boards = std::move(*boards);
            seen_.registry = source_.registry();
            seen_.answered = std::chrono::system_clock::now();
        }
        if (seen_.registry.empty()) seen_.boards = source_.bus().boards({}, catalogue::instant_now());
        seen_.bad_documents = source_.bus().refused();
    }

    struct Asked {
        BusSession::Request request;
        Time until;
        std::string topic;
        bool answered = false;
    };

    /// All of them, a few at a time.
    void ping_boards() {
        std::vector<std::string> boards;
        for (const auto& board : seen_.boards)
            if (board.state == "online" && !board.names_only) boards.push_back(board.board);
        std::list<Asked> asked;
        for (auto next = boards.begin(); (next != boards.end() || !asked.empty()) && !session_.stopped();) {
            for (; next != boards.end() && asked.size() < kMaxOpenPings; ++next)
                ping(*next, asked.emplace_back());
            const auto settled = [this](const Asked& one) {
                return one.answered || session_.denied(one.topic);
            };
            session_.run_until([&] { return std::any_of(asked.begin(), asked.end(), settled); },
                               asked.front().until);
            const auto now = Clock::now();
            std::erase_if(asked, [&](const Asked& one) { return settled(one) || now >= one.until; });
        }
        for (auto& [board, result] : seen_.pings)
            result.denied = session_.denied(environment_.topics.board_in(board));
    }

    void ping(const std::string& board, Asked& asked) {
        auto& result = seen_.pings[board];
        asked.until = Clock::now() + environment_.timeout;
        asked.topic = environment_.topics.board_in(board);
        asked.request = session_.ask(
            asked.topic, std::string(protocol::kAskInfo),
            [this, &result, &asked](const mqtt::Message& message) {
                if (auto reply = bus::parse_reply(message.payload)) result.reply = std::move(*reply);
                result.properties_lost = session_.v5() && message.correlation.empty();
                asked.answered = true;
            },
            1);
    }

    Environment& environment_;
    BusSession& session_;
    BoardSource& source_;
    Observations seen_;
};

int print(const Findings& findings, const DoctorOptions& options, Environment& environment) {
    if (options.output.for_people()) {
        environment.out << findings_text(findings, environment.colour) << std::flush;
    } else {
        RecordPrinter records(options.output, RecordPrinter::Count::kList, environment.out);
        for (const auto& finding : findings)
            records.print(finding_json(finding));
        records.finish();
    }
    return has_problem(findings) ? program::kExitFailure : program::kExitOk;
}

std::string broker_advice(const std::string& broker) {
    return "is a broker running there? A secured one needs --credentials FILE. Try: mosquitto_sub -h HOST -p "
           "PORT -t '$SYS/#' -C 1. Mosquitto 2 takes only local and no anonymous clients unless its "
           "configuration allows it; ours: packaging/mosquitto/asip.conf. We tried " +
           broker;
}

/// Nothing but this machine can be judged.
int print_broker_problem(const Failure& problem, const DoctorOptions& options, Environment& environment) {
    Findings findings{
        {Finding::Level::kProblem, problem.text, broker_advice(environment.mqtt.brokers.front().describe())}};
    auto local = check_machine(look_at_machine());
    std::move(local.begin(), local.end(), std::back_inserter(findings));
    print(findings, options, environment);
    return problem.status;
}

/// `asipctl doctor`: looks at broker, registry, boards and this machine. kExitFailure when something is
/// wrong, kExitBroker when the broker is.
int run_doctor(const DoctorOptions& options, Environment& environment) {
    environment.mqtt.quick_ack = false;  // what other clients see is to be measured
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected)
        return print_broker_problem(connected.error(), options, environment);
    const auto seen = Examination(environment, session, source).look();
    if (seen) return print(check_all(*seen), options, environment);
    return session.stopped() ? environment.fail_with(seen.error())
                             : print_broker_problem(seen.error(), options, environment);
}

Run declare_doctor(Declaration& verb) {
    auto options = std::make_shared<DoctorOptions>();
    verb.flag("--agents", options->agents,
              "List what agents counted since they started: lines, commands, round trips, losses");
    verb.output(options->output, {Output::kTable, Output::kName},
                {"level", "what", "advice", "board", "version", "seq", "at", "uptime", "line", "commands",
                 "round_trip", "queue", "holds", "stops", "bus", "number", "interval", "session"});
    return [options](Environment& environment) {
        return options->agents ? list_agents(options->output, environment)
                               : run_doctor(*options, environment);
    };
}

}  // namespace

Verb doctor_verb() {
    return {
        "doctor", "Find what is wrong with broker, registry, boards and this machine",
        "Each finding names what to do. Exit status: 0 nothing is wrong, 1 something is, 3 the broker is.\n"
        "With --agents: 4, there is none.\n"
        "Examples:\n"
        "  asipctl doctor --broker pi.local\n"
        "  asipctl doctor --agents -o json | jq '.[].round_trip'",
        declare_doctor};
}

}  // namespace asip::cli
