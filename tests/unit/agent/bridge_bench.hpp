// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "agent/bridge/bridge.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace asip::agent {

using namespace std::chrono_literals;

/// A bridge between a scripted board and a list of what was published.
class BridgeBench {
  public:
    explicit BridgeBench(BridgeOptions options = defaults())
        : bridge(std::move(options), model::ModelSet::standard(), [] { return std::uint64_t{1} << 60; }) {}

    static BridgeOptions defaults() {
        BridgeOptions options;
        options.name = "uno1";
        options.started_unix = 1000;
        options.session.max_baud = 0;
        return options;
    }

    session::ScriptedBoard board;
    Bridge bridge;
    Time now{};
    std::vector<Publication> published;
    bool grants_subscriptions = true;
    std::vector<std::string> client_lines;  ///< for all of them
    std::vector<ClientLine> lines_for_one;
    std::vector<std::string> notices;
    std::size_t logged = 0;  ///< of these, unless one asks for more
    std::optional<Fatal> fatal;
    bool begin_anew = false;
    std::vector<model::Labels> to_keep;         ///< what was to be written to the disk
    std::vector<LinkToKeep> links_to_keep;      ///< the same
    Effects::Port port = Effects::Port::kKeep;  ///< what the agent did last with the port
    std::optional<Effects::Load> to_load;

    void plug() {
        run([&](Effects& out) {
            bridge.link_up({57600, false}, {"serial", "/dev/ttyACM0", 57600}, now, out);
        });
    }
    void unplug() {
        run([&](Effects& out) { bridge.link_down("gone", now, out); });
    }
    void connect(bool expires = true) {
        run([&](Effects& out) { bridge.bus_connected(now, "client", expires, out); });
        bridge.sources_heard(true, now);
        if (grants_subscriptions) run([&](Effects& out) { bridge.bus_subscribed(now, out); });
    }
    /// Board, bus, and the name claimed.
    void go_online() {
        plug();
        connect();
        pass(1500ms);
    }
    void say(std::string_view bytes) {
        run([&](Effects& out) { bridge.receive(bytes, now, out); });
    }
    /// The agent reads the message at `read_at`, or now, and handles it now. `stopped`: a stop came
    /// meanwhile.
    void hear(const mqtt::Message& message, std::optional<Time> read_at = {}, bool stopped = false) {
        auto inbound = bridge.read(message, read_at.value_or(now));
        if (!inbound) return;
        if (auto* command = std::get_if<Command>(&*inbound)) command->stopped = stopped;
        run([&](Effects& out) { bridge.take(*inbound, now, out); });
    }
    void hear(const std::string& topic, const std::string& payload, bool retained = false) {
        hear(mqtt::Message{.topic = topic, .payload = payload, .retain = retained});
    }
    Bridge::ClientResult client_says(std::string_view line, session::ClientId client = 1,
                                     std::optional<Time> sent = {}) {
        auto result = Bridge::ClientResult::kAccepted;
        run([&](Effects& out) { result = bridge.client_line(client, line, sent, now, out); });
        return result;
    }
    void release_holds() {
        run([&](Effects& out) { bridge.release_holds(now, out); });
    }
    void labels_kept(const Expected<std::filesystem::path>& result = {}) {
        run([&](Effects& out) { bridge.labels_kept(result, now, out); });
    }
    void publish_statistics() {
        run([&](Effects& out) { bridge.publish_statistics({}, now, out); });
    }
    void pass(Duration time) {
        const Time end = now + time;
        while (true) {
            const auto deadline = bridge.next_deadline();
            if (!deadline || *deadline > end) break;
            now = std::max(*deadline, now + 1us);
            run([&](Effects& out) { bridge.tick(now, out); });
        }
        now = end;
    }
    /// Payloads on `topic`, in order.
    std::vector<std::string> on(const std::string& topic) const {
        std::vector<std::string> payloads;
        for (const auto& publication : published)
            if (publication.message.topic == topic) payloads.push_back(publication.message.payload);
        return payloads;
    }
    /// The answer to a JSON command with id "1", which `command` must not have.
    nlohmann::json ask(const std::string& topic, nlohmann::json command, const std::string& id = "1") {
        command["id"] = id;
        command["reply_to"] = "answers";
        hear(topic, command.dump());
        const auto answers = on("answers");
        return answers.empty() ? nlohmann::json() : nlohmann::json::parse(answers.back());
    }

    /// A call of the bridge that has no name here.
    template <class Call>
    void run(Call&& call) {
        Effects effects;
        call(effects);
        bridge.publish_values(now, effects);
        perform(effects);
    }

  private:
    void perform(Effects& effects) {
        std::string answer;
        for (auto& action : effects.link)
            if (auto* write = std::get_if<session::Write>(&action))
                answer += board.hear(write->bytes, 57600, now);
        for (auto& publication : effects.publish)
            published.push_back(std::move(publication));
        for (auto& note : effects.notes)
            published.push_back({std::move(note), mqtt::Priority::kReply});
        for (auto& line : effects.lines)
            line.client ? lines_for_one.push_back(line) : client_lines.push_back(line.line);
        for (auto& notice : effects.notices)
            notices.push_back(notice.text), logged += notice.level >= program::log::Level::kInfo ? 1 : 0;
        if (effects.keep_labels) to_keep.push_back(effects.keep_labels->labels);
        for (auto& link : effects.keep_links)
            links_to_keep.push_back(std::move(link));
        if (effects.fatal) fatal = effects.fatal;
        begin_anew = begin_anew || effects.begin_anew;
        if (effects.port != Effects::Port::kKeep) port = effects.port;
        if (effects.load) to_load = effects.load;
        if (effects.stopped) run([&](Effects& out) { bridge.refuse_waiting(now, out); });
        if (!answer.empty()) say(answer);
        if (effects.name_claimed && grants_subscriptions)
            run([&](Effects& out) { bridge.bus_subscribed(now, out); });
    }
};

/// With the board on the bus, its name claimed.
struct OnlineBench : BridgeBench {
    explicit OnlineBench(BridgeOptions options = defaults()) : BridgeBench(std::move(options)) {
        go_online();
    }
};

}  // namespace asip::agent
