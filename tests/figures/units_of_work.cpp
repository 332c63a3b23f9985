// SPDX-License-Identifier: Apache-2.0
// Units of work with fixed inputs, for `check`: under callgrind each part of this program is counted by
// itself, and its allocations are printed. `--worse`: each does five hundredths more, which is refused.
#include <valgrind/callgrind.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <new>
#include <string>
#include <string_view>

#include "asip/bus/registry/answer.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "bench/catalogue_load.hpp"
#include "cli/commands/list.hpp"
#include "gateway/export/sparkplug_node.hpp"
#include "registry/registry.hpp"
#include "tests/unit/agent/bridge_bench.hpp"
#include "tests/unit/gateway/api_bench.hpp"
#include "tests/unit/gateway/export/export_world.hpp"

namespace {

std::size_t allocations;  // since the program began
bool worse = false;

}  // namespace

void* operator new(std::size_t size) {
    ++allocations;
    if (void* const memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace asip {
namespace {

using namespace std::chrono_literals;

void measure(const char* name, unsigned count, const std::function<void(unsigned)>& work) {
    for (unsigned i = 0; i < count; ++i)  // what is made once is there
        work(i);
    const std::size_t before = allocations;
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    for (unsigned i = count; i < 2 * count + (worse ? count / 20 + 1 : 0); ++i)
        work(i);
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT(name);
    std::printf("%s %u %zu\n", name, count, allocations - before);
}

/// What a program asks of a board by lines, and hears of it. `extensions`: a line that was stepped up has a
/// checksum.
void lines_through_agent(const char* name, bool extensions) {
    auto options = agent::BridgeBench::defaults();
    if (extensions) options.session.checksum = session::ChecksumPolicy::kAlways;
    agent::BridgeBench bench(std::move(options));
    bench.board.extensions = extensions;
    bench.go_online();
    if (bench.board.checksum != extensions) std::abort();
    measure(name, 100, [&](unsigned i) {
        bench.hear("asip/uno1/in", i % 2 ? "I,d,2,1" : "I,d,2,0");
        bench.pass(2ms);
        bench.say(bench.board.framed("@I,d,3," + std::to_string(i % 2)));
        bench.pass(2ms);
        if (bench.board.executed.size() != 1 || bench.on("asip/uno1/out").empty()) std::abort();
        bench.published.clear();
        bench.board.executed.clear();
        bench.board.heard.clear();
    });
}

void agent_units() {
    agent::BridgeBench bench;
    bench.board.verified_fences = true;
    bench.go_online();
    measure("command-through-agent", 100, [&](unsigned i) {
        mqtt::Message message;
        message.topic = "asip/uno1/servo/in";
        message.payload = "{\"write\":[0," + std::to_string(i % 180) + "]}";
        message.response_topic = "answers";
        message.correlation = std::to_string(i);
        bench.hear(message);
        bench.pass(2ms);
        if (bench.on("answers").size() != 1) std::abort();
        bench.published.clear();
        bench.board.executed.clear();
        bench.board.heard.clear();
    });
    measure("value-to-topic", 100, [&](unsigned i) {
        bench.say("@D,e,1,{" + std::to_string(10 + i) + "}\r\n");
        bench.pass(20ms);
        if (bench.published.empty()) std::abort();
        bench.published.clear();
    });
}

agent::BridgeOptions board_named(const char* name) {
    auto options = agent::BridgeBench::defaults();
    options.name = name;
    return options;
}

/// A button of one board and a servo of another, with a link.
struct Linked {
    agent::BridgeBench desk{board_named("desk")}, lamp{board_named("lamp")};
    Linked() {
        desk.go_online();
        lamp.go_online();
        desk.ask("asip/desk/io/in", {{"mode", {2, 2}}}, "1");
        desk.ask("asip/desk/in", {{"meanings", {{"io/2", {{"class", "button"}}}}}}, "2");
        desk.labels_kept();
        const nlohmann::json link{
            {"name", "l"}, {"from", "desk/io/2"}, {"to", "servo/0/angle"}, {"value", 90}, {"else", 0}};
        lamp.ask("asip/lamp/$link/ann/c", {{"set", link}});
        for (const auto& each : std::exchange(lamp.links_to_keep, {}))
            lamp.run([&](agent::Effects& out) { lamp.bridge.link_kept(each.ticket, {}, lamp.now, out); });
        for (const auto& each : {"asip/servicebus/desk/$state", "asip/servicebus/desk/$properties"})
            hear(each, desk.on(each).back());
    }
    void hear(const std::string& topic, const std::string& payload) {
        lamp.run([&](agent::Effects& out) {
            lamp.bridge.source_message({.topic = topic, .payload = payload}, lamp.now, out);
        });
    }
    void press(unsigned i) {
        desk.pass(200ms);
        lamp.pass(200ms);
        for (auto* each : {&desk, &lamp}) {
            each->published.clear();
            each->board.executed.clear();
            each->board.heard.clear();
        }
        lamp.links_to_keep.clear();
        desk.say(i % 2 ? "@I,d,4,0\r\n" : "@I,d,4,4\r\n");
    }
    void check() const {
        if (lamp.board.executed.size() != 1) std::abort();
    }
};

void link_units() {
    Linked far;
    measure("press-to-level-of-another-agent", 100, [&](unsigned i) {
        far.press(i);
        far.hear("asip/desk/$values", far.desk.on("asip/desk/$values").at(0));
        far.check();
    });
    Linked near;
    measure("press-to-level-in-one-agent", 100, [&](unsigned i) {
        near.press(i);
        near.lamp.run([&](agent::Effects& out) {
            near.lamp.bridge.source_stands(near.desk.bridge.standing(near.desk.now), near.lamp.now, out);
        });
        near.check();
    });
}

/// The first announcements of boards to a registry, until a watcher has the change.
void changes_of_registry() {
    const bench::BoardTexts texts;
    std::size_t changes = 0;
    registry::RegistryOptions options;
    options.id = "r1";
    const bus::Topics topics;
    registry::Port port;
    port.publish = [&](const mqtt::Message& message) {
        changes += message.topic == topics.registry_events("r1") ? 1 : 0;
    };
    port.subscribe = [](const std::string&, bool) {};
    port.unsubscribe = [](const std::string&) {};
    registry::Registry registry(options, model::ModelSet(), [n = 0ull]() mutable { return ++n << 40; }, port,
                                nullptr, {Time{} + 1h, {}});
    registry.connected(0, {Time{} + 1h, {}});
    for (auto passed = 0ms; passed < 20s; passed += 100ms)  // nothing more is retained
        registry.tick({Time{} + 1h + passed, {}});
    measure("announcement-to-change-event", 100, [&](unsigned i) {
        changes = 0;
        registry.message({.topic = "asip/servicebus/" + bench::BoardTexts::name(i) + "/$description",
                          .payload = texts.description(i, 1)},
                         {Time{} + 1h + 20s, {}});
        if (changes != 1) std::abort();
    });
}

void first_announcements(const char* name, bool distinct) {
    constexpr unsigned kBoards = 400;
    const bench::BoardTexts texts(distinct);
    catalogue::Catalogue catalogue;
    std::vector<std::string> names, descriptions;
    for (unsigned i = 0; i < 2 * kBoards; ++i) {
        names.push_back(bench::BoardTexts::name(i));
        descriptions.push_back(texts.description(i, 1));
    }
    measure(name, kBoards, [&](unsigned i) {
        catalogue.apply({bus::TopicKind::kDescription, names[i], descriptions[i], false, std::nullopt},
                        Time{} + 1h);
    });
}

void registry_units() {
    constexpr unsigned kBoards = 1000;
    const bench::BoardTexts texts;
    catalogue::Catalogue catalogue;
    std::vector<std::string> names, first, again;
    for (unsigned i = 0; i < kBoards; ++i) {
        names.push_back(bench::BoardTexts::name(i));
        first.push_back(texts.description(i, 1));
        again.push_back(texts.description(i, 2));
    }
    const auto apply = [&](bus::TopicKind kind, unsigned board, std::string_view payload, Time now) {
        catalogue.apply({kind, names[board], payload, false, std::nullopt}, now);
    };
    for (unsigned i = 0; i < kBoards; ++i)
        apply(bus::TopicKind::kDescription, i, first[i], Time{} + 1h);
    measure("renewal-in-registry", 400,
            [&](unsigned i) { apply(bus::TopicKind::kDescription, i, again[i], Time{} + 1h + 20s); });
    for (unsigned i = 0; i < kBoards; ++i)
        apply(bus::TopicKind::kDescription, i, again[i], Time{} + 1h + 21s);
    for (unsigned i = 0; i < kBoards; ++i)
        apply(bus::TopicKind::kState, i, "online", Time{} + 1h + 21s);
    const catalogue::Instant now{Time{} + 1h + 22s, {}};
    bus::Query services;
    services.find = bus::Find::kServices;
    services.kind = {"servo"};
    services.state = {"online"};
    measure("query-of-100-services", 10, [&](unsigned) {
        const auto answer = catalogue.find(services, now);
        if (!answer || bus::encode(*answer).size() < 1000) std::abort();
    });
    bus::Query boards;
    boards.limit = kBoards;
    measure("list-of-1000-boards", 2, [&](unsigned) {
        const auto answer = catalogue.find(boards, now);
        if (!answer || answer->boards.size() != kBoards) std::abort();
        const auto read = bus::parse_answer(bus::encode(*answer));
        if (!read) std::abort();
        if (cli::boards_text(read->boards, cli::Output::kTable, 120, false).size() < 50 * kBoards)
            std::abort();
    });
}

struct GatewayUnits : gateway::ApiTest {
    void TestBody() override {
        announce();
        measure("get-of-a-board", 50, [&](unsigned) {
            if (get("/api/boards/uno1")->status() != 200) std::abort();
        });
        const auto stream = ask("GET", "/api/stream", {},
                                {{"upgrade", "websocket"},
                                 {"connection", "upgrade"},
                                 {"sec-websocket-version", "13"},
                                 {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}});
        if (!stream->channel) std::abort();
        stream->channel->received(R"({"subscribe":"uno1/distance","ref":1})");
        std::string text;
        while (stream->channel->take(text))
            text.clear();
        measure("value-to-websocket", 100, [&](unsigned i) {
            bus("asip/uno1/distance/out", R"({"distance":[)" + std::to_string(i) + "]}");
            pass(20ms);
            std::size_t messages = 0;
            for (text.clear(); stream->channel->take(text); text.clear())
                ++messages;
            if (messages != 1) std::abort();
        });
        const auto values = get("/api/boards/uno1/values/stream");
        if (!values->source) std::abort();
        measure("value-to-values-stream", 100, [&](unsigned i) {
            bus("asip/uno1/$values", R"({"version":1,"board":"uno1","session":"s1","seq":)" +
                                         std::to_string(i + 1) + R"(,"values":{"servo/0/angle":{"value":)" +
                                         std::to_string(i % 180) + R"(,"how":"set","age":0}}})");
            pass(100ms);
            text.clear();
            values->source->take(text, 65536);
            if (text.find("servo/0/angle") == std::string::npos) std::abort();
        });
        measure("post-of-a-command", 50, [&](unsigned i) {
            const auto sent = ask("POST", "/api/boards/uno1/services/servo/commands/write",
                                  "[0," + std::to_string(i) + "]");
            if (sent->status() != 0 || published_.empty()) std::abort();
            answer(R"({"status":"ok","proof":"fence"})");
            if (sent->status() != 200) std::abort();
            published_.clear();
        });
        births();
    }

  private:
    /// Boards that come, until each is born for hosts of Sparkplug.
    void births() {
        using namespace gateway::exports;
        ExportWorld world;
        world.start([this](Random random, Export::Port port) {
            port.board = [this](const std::string& name) -> std::optional<Export::Present> {
                auto found = gateway_->things().find(gateway_->mirror(), name, gateway_->now());
                if (!found) return std::nullopt;
                return Export::Present{true, std::move(found->board), found->state,
                                       std::move(found->session)};
            };
            SparkplugNode::Options options;
            options.dialect.group = "plant";
            options.gateway = "gw1";
            options.host = "host";
            return std::make_unique<SparkplugNode>(options, std::move(random), std::move(port));
        });
        world.pass(3s);
        measure("birth-of-sparkplug", 50, [&](unsigned i) {
            const auto name = "board" + std::to_string(i);
            announce(name);
            world.sent.clear();
            world.changed(name);
            world.step();
            const bool born = std::any_of(world.sent.begin(), world.sent.end(), [&](const auto& sent) {
                return sent.topic == "spBv1.0/plant/DBIRTH/asip/" + name;
            });
            if (!born) std::abort();
        });
    }
};

}  // namespace
}  // namespace asip

int main(int argc, char** argv) {
    worse = argc > 1 && std::string_view(argv[1]) == "--worse";
    asip::program::log::configure(asip::program::log::Level::kOff, asip::program::log::Format::kText);
    asip::agent_units();
    if (worse) return 0;  // one figure that is refused is enough
    asip::lines_through_agent("line-through-agent-to-event", false);
    asip::lines_through_agent("line-with-checksum-to-event", true);
    asip::link_units();
    asip::changes_of_registry();
    asip::first_announcements("announcement-in-registry", false);
    asip::first_announcements("announcement-of-a-board-like-no-other", true);
    asip::registry_units();
    asip::GatewayUnits().TestBody();
}
