// SPDX-License-Identifier: Apache-2.0
#include "cli/doctor/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/topics.hpp"
#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/flash/no_asip.hpp"
#include "cli/text/state_text.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

// Without TCP_NODELAY an acknowledgement waits for the other side's delayed one: 40 ms and more; with it,
// well below 1.
constexpr std::chrono::duration<double> kSlowAcknowledgement = 30ms;
constexpr std::chrono::duration<double> kClockTolerance = 2s;
constexpr std::size_t kNamed = 5;

std::string some_of(const std::vector<std::string>& all) {
    std::string text;
    for (std::size_t i = 0; i < std::min(all.size(), kNamed); ++i)
        text += (i == 0 ? "" : ", ") + all[i];
    if (all.size() > kNamed) text += fmt::format(" and {} more", all.size() - kNamed);
    return text;
}

std::string retained_payload(const Observations& seen, const std::string& topic) {
    for (const auto& message : seen.retained)
        if (message.topic == topic) return message.payload;
    return {};
}

bool answers(const Observations& seen, const std::string& board) {
    const auto ping = seen.pings.find(board);
    return ping != seen.pings.end() && ping->second.reply && ping->second.reply->succeeded();
}

Finding ping_finding(const std::string& board, const PingResult& ping) {
    if (!ping.reply) {
        return problem(board + " is reported online, but nothing answers for it",
                       "its agent is gone or stuck: restart it (systemctl restart asip-agent@" + board +
                           "), else: asipctl forget " + board);
    }
    using Status = bus::Reply::Status;
    switch (ping.reply->status) {
        case Status::kOk:
            return fine(board + " answers");
        case Status::kTimeout:
            return problem(
                board + ": its agent answers, the board does not",
                "check cable and power, reset the board; its log: journalctl -u asip-agent@" + board);
        case Status::kError:
            return problem(
                board + " answers error " + std::to_string(ping.reply->code) + ", " + ping.reply->error,
                "the firmware does not know the request: does it speak ASIP 0.4?");
        case Status::kRefused:
            break;
    }
    return problem(
        board + ": its agent answers, but refuses (" + ping.reply->reason + "): " + ping.reply->error,
        "an agent without its board: plug it in again; its log: journalctl -u asip-agent@" + board);
}

/// Mosquitto delivers a message in a packet that may be larger than the one in which it came: the topic
/// stands in it, up to 64 KiB, where the sender used an alias for it.
Findings check_limit(const Observations& seen) {
    constexpr std::size_t kOurs = mqtt::Options::kMaxPacketBytes;
    constexpr std::size_t kMax = kOurs - (kOurs >> 4);
    if (!seen.v5 || (seen.max_packet_bytes != 0 && seen.max_packet_bytes <= kMax)) return {};
    const auto what =
        (seen.max_packet_bytes == 0
             ? std::string("the broker takes messages of any size")
             : fmt::format("the broker takes messages up to {} bytes", seen.max_packet_bytes)) +
        fmt::format(
            ", and our programs up to {}: a few larger ones make a program deaf until it connects again",
            kOurs);
    const auto advice =
        fmt::format("Mosquitto: add the line  max_packet_size {}  to its configuration and restart it",
                    bus::kBrokerPacketBytes);
    return {seen.open == true ? note(what, advice) : problem(what, advice)};
}

}  // namespace

Findings check_broker(const Observations& seen) {
    Findings result;
    result.push_back(
        fine("broker " + seen.broker + ": connection accepted (MQTT " + (seen.v5 ? "5" : "3.1.1") + ")"));
    if (!seen.v5) {
        result.push_back(note("the broker speaks MQTT 3.1.1 only: descriptions do not expire by themselves",
                              "run asip-registry, which clears them, or a broker with MQTT 5"));
    }
    for (auto& finding : check_limit(seen))
        result.push_back(std::move(finding));
    if (seen.open == true) {
        const std::string what =
            "the bus is open: every program that reaches the broker may read everything and command every "
            "board";
        const std::string advice = "on the broker's machine: asipctl secure init; see asipctl secure --help";
        result.push_back(seen.loopback ? note(what, advice) : problem(what, advice));
    } else if (seen.open == false) {
        result.push_back(fine("the broker lets in known users only"));
    }
    if (!seen.acknowledged) {
        result.push_back(
            problem("a message of our own did not come back",
                    "do the access rules let us subscribe below " + seen.topics.root() + "/reply/ ?"));
    } else if (*seen.acknowledged > kSlowAcknowledgement) {
        result.push_back(
            note("a message takes " + text::duration_text(*seen.acknowledged) +
                     " out and back; a slow network, or TCP_NODELAY is missing on the broker",
                 "Mosquitto: add the line  set_tcp_nodelay true  to its configuration and restart it"));
    } else {
        result.push_back(
            fine("a message takes " + text::duration_text(*seen.acknowledged) + " out and back"));
    }
    return result;
}

Findings check_registry(const Observations& seen) {
    if (!seen.registry.empty()) {
        Findings result{fine("registry " + seen.registry + " answers")};
        for (const auto& id : seen.registries) {
            const auto stats = model::parse_json(retained_payload(seen, seen.topics.registry_stats(id)))
                                   .value_or(nlohmann::json());
            for (const std::string what : {"history", "values"})
                if (const auto why = stats.find(what + "_fault"); why != stats.end() && why->is_string())
                    result.push_back(problem(
                        fmt::format("registry {} cannot keep {}: {}", id, what, why->get<std::string>()),
                        "look at its disk; its log: journalctl -u asip-registry"));
        }
        return result;
    }
    if (!seen.registries.empty())
        return {problem("registry " + some_of(seen.registries) + " is reported online, but does not answer",
                        "restart it: systemctl restart asip-registry")};
    return {note("no registry runs; what follows comes from the bus itself",
                 "start one: asip-registry, or systemctl enable --now asip-registry")};
}

Findings check_boards(const Observations& seen) {
    Findings result;
    if (seen.boards.empty()) {
        const bool plug = seen.loopback && seen.machine.starts_agents;
        result.push_back(note("there is no board",
                              plug ? "plug one in, or start an agent for one that is elsewhere: asip-agent "
                                     "--tcp HOST:PORT, or try asip-sim"
                                   : "start an agent: asip-agent --serial /dev/ttyACM0, or try asip-sim"));
    }
    std::vector<std::string> answering, denied;
    for (const auto& [board, ping] : seen.pings) {
        if (ping.denied && !ping.reply) {
            denied.push_back(board);
            continue;
        }
        auto finding = ping_finding(board, ping);
        if (finding.level == Finding::Level::kFine)
            answering.push_back(board);
        else
            result.push_back(std::move(finding));
    }
    if (!denied.empty()) {
        result.push_back(note("not asked: " + some_of(denied) + "; the broker does not let us command boards",
                              "for the whole check be an operator: asipctl secure add operator NAME"));
    }
    if (!answering.empty()) {
        result.push_back(
            fine(fmt::format("{} board{} answer{}: {}", answering.size(), answering.size() == 1 ? "" : "s",
                             answering.size() == 1 ? "s" : "", some_of(answering))));
    }
    return result;
}

Findings check_states(const Observations& seen) {
    Findings result;
    for (const auto& board : seen.boards) {
        const auto kept = retained_payload(seen, seen.topics.state(board.board));
        const bool described = !retained_payload(seen, seen.topics.description(board.board)).empty();
        if (kept == "online" && !described && !board.names_only) {
            result.push_back(problem(
                board.board + " is retained as online, but its description has expired",
                "it died without a will: asipctl forget " + board.board + ", or start its agent again"));
        } else if (kept == "online" && board.state == "lost") {
            result.push_back(problem(board.board + " is retained as online, but its lease ran out",
                                     "restart its agent, or: asipctl forget " + board.board));
        } else if (kept == "lost" && answers(seen, board.board) && board.state == "online") {
            result.push_back(problem(board.board + " is retained as lost by a late will, but it answers",
                                     "its agent should put that right at once: restart it"));
        } else if (speaks_no_asip(board)) {
            result.push_back(problem("a board at " + port_text(board.link.substr(board.link.find(' ') + 1)) +
                                         " that speaks no ASIP (" + board.board + ")",
                                     "load AsipServices: asipctl flash " + board.board +
                                         "; several boards: asipctl flash --class"));
        } else if (board.state == "lost") {
            const bool agent_gone = board.reason == model::to_text(model::StateReason::kAgentGone);
            result.push_back(note(
                board.board + " is " + state_text(board),
                what_to_do(board) + (agent_gone ? ". An agent that was killed leaves its board at a fast "
                                                  "rate: until a restart, others read garbage at its port"
                                                : "")));
        }
    }
    for (const auto& [topic, reason] : seen.bad_documents) {
        if (!seen.topics.parse(topic)) continue;  // its name is the fault: check_names
        result.push_back(
            problem(topic + " cannot be read: " + reason,
                    "which program publishes it? Clear it: asipctl forget --leftovers --only documents"));
    }
    return result;
}

Findings check_retained(const Observations& seen) {
    std::vector<std::string> commands;
    std::vector<std::string> orphans;
    for (const auto& one : find_lingering(seen.topics, seen.retained)) {
        if (one.kind == Lingering::Kind::kCommand) commands.push_back(one.topic);
        if (one.kind == Lingering::Kind::kOrphan) orphans.push_back(one.topic);
    }
    Findings result;
    if (!commands.empty()) {
        result.push_back(problem(
            "retained commands, delivered again at each reconnection: " + some_of(commands),
            "asipctl forget --leftovers --only commands; and publish commands without the retain flag"));
    }
    if (!orphans.empty()) {
        result.push_back(note("retained values of boards that are not announced: " + some_of(orphans),
                              "asipctl forget --leftovers --only orphans"));
    }
    return result;
}

Findings check_names(const Observations& seen) {
    std::vector<std::string> bad;
    for (const auto& one : find_lingering(seen.topics, seen.retained))
        if (one.kind == Lingering::Kind::kInvalidName) bad.push_back(one.topic);
    if (bad.empty()) return {};
    return {problem("announced under names that are not valid, so that they are ignored: " + some_of(bad),
                    "names are 1 to 64 of A-Z a-z 0-9 . _ -; rename the board, then: asipctl forget "
                    "--leftovers --only names")};
}

Findings check_conflicts(const Observations& seen) {
    Findings result;
    for (const auto& board : seen.boards) {
        const auto live = seen.sessions.find(board.board);
        const bool two = live != seen.sessions.end() && live->second.size() > 1;
        if (!board.conflict && !two) continue;
        const auto who = board.conflict ? ": " + board.agent + " and " + board.conflict->other_agent : "";
        result.push_back(problem("two agents claim the name " + board.board + who,
                                 "give one of the boards another name: asip-agent --name NAME"));
    }
    return result;
}

Findings check_clocks(const Observations& seen) {
    if (seen.registry.empty()) return {};  // the times of its boards are ours
    for (const auto& board : seen.boards) {
        if (board.age < 0 || board.last_seen == text::WallTime{}) continue;
        const auto registry_now = board.last_seen + std::chrono::duration_cast<std::chrono::milliseconds>(
                                                        std::chrono::duration<double>(board.age));
        // What an answer needed to come here, page after page, is no difference of clocks.
        std::chrono::duration<double> skew{};
        if (registry_now < seen.asked) skew = seen.asked - registry_now;
        if (registry_now > seen.answered) skew = seen.answered - registry_now;
        if (skew < kClockTolerance && skew > -kClockTolerance)
            return {fine("our clock and the registry's agree")};
        const auto size = std::chrono::duration<double>(std::abs(skew.count()));
        return {problem("our clock is " + text::duration_text(size) +
                            (skew.count() > 0 ? " ahead of" : " behind") + " the registry's",
                        "let both machines keep time: timedatectl set-ntp true")};
    }
    return {};
}

Findings check_bridges(const Observations& seen) {
    std::vector<std::string> boards;
    for (const auto& [board, ping] : seen.pings)
        if (ping.properties_lost) boards.push_back(board);
    if (boards.empty()) return {};
    return {note("a bridge between brokers drops the properties of MQTT 5 on the way to " + some_of(boards) +
                     ": commands work, but brokers do not drop those that come too late",
                 "Mosquitto: add  bridge_protocol_version mqttv50  to the connection of the bridge")};
}

Findings check_warnings(const Observations& seen) {
    Findings result;
    for (const auto& message : seen.retained) {
        const auto topic = seen.topics.parse(message.topic);
        if (!topic || topic->kind != bus::TopicKind::kDescription) continue;
        const auto description = model::parse_description(message.payload);
        if (!description || speaks_no_asip(*description)) continue;  // check_states says it
        for (const auto& warning : description->warnings)
            result.push_back(problem(std::string(topic->board) + ": " + warning,
                                     "asipctl show " + std::string(topic->board) +
                                         "; its log: asipctl events --logs " + std::string(topic->board)));
    }
    return result;
}

Findings check_exports(const Observations& seen) {
    const auto base = seen.topics.root() + "/export/ha/";
    bool exports = false;
    const auto dashboard = seen.topics.root() + "/export/dashboard/";
    std::size_t boards = 0, dashboards = 0;
    for (const auto& message : seen.retained) {
        const std::string_view topic = message.topic;
        if (topic.starts_with(dashboard) && message.payload != R"({"removed":true})") ++dashboards;
        if (topic == base + "$state")
            exports = message.payload == "online";
        else if (topic.starts_with(base) && topic.ends_with("/$state"))
            ++boards;
    }
    Findings result;
    if (dashboards > 0)
        result.push_back(fine(std::to_string(dashboards) +
                              (dashboards == 1 ? " dashboard is" : " dashboards are") + " kept on the bus"));
    if (exports)
        result.push_back(fine("a gateway shows " + std::to_string(boards) +
                              (boards == 1 ? " board" : " boards") + " to Home Assistant"));
    if (exports || !seen.home_assistant) return result;
    result.push_back(note("Home Assistant uses this broker, and no gateway shows it boards",
                          "on the gateway's machine: sudo asip-gateway export home-assistant"));
    return result;
}

Findings check_all(const Observations& seen) {
    Findings result;
    for (auto* check :
         {check_broker, check_registry, check_boards, check_states, check_bridges, check_warnings,
          check_exports, check_retained, check_names, check_conflicts, check_clocks}) {
        auto some = check(seen);
        std::move(some.begin(), some.end(), std::back_inserter(result));
    }
    auto local = check_machine(seen.machine);
    std::move(local.begin(), local.end(), std::back_inserter(result));
    return result;
}

}  // namespace asip::cli
