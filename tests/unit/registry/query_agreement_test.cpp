// SPDX-License-Identifier: Apache-2.0
// A query has one answer, whoever looks: a registry's catalogue, or asipctl that reads the bus itself.
#include <gmock/gmock.h>

#include <random>

#include "asip/bus/mirror.hpp"
#include "asip/model/model_set.hpp"
#include "bus_messages.hpp"
#include "registry/catalogue/catalogue.hpp"

namespace asip::registry {
namespace {

using Engine = std::mt19937;

const model::ModelSet& models() {
    return model::ModelSet::standard();
}

template <class T>
const T& one_of(Engine& engine, const std::vector<T>& choices) {
    return choices[engine() % choices.size()];
}

std::string own_model(Engine& engine) {
    const std::string unit = one_of<std::string>(engine, {"cm", "lux", "%"});
    const std::string fields = R"([{"name":"level","type":"integer","unit":")" + unit + R"("}])";
    const std::string part = engine() % 2 == 0 ? R"("events":{"e":{"name":"light","fields":)" + fields + "}}"
                                               : R"("commands":{"dim":{"tag":"W","args":)" + fields + "}}";
    return R"({"name":"lamp","version":1,"id":"L","title":"A lamp",)" + part + "}";
}

std::string services(Engine& engine) {
    std::vector<std::string> all;
    for (const std::string name : {"servo", "distance", "tone", "io", "heading"}) {
        if (engine() % 3 != 0) continue;
        const std::string version = engine() % 5 == 0 ? "@9" : "@1";
        all.push_back(R"({"name":")" + name + R"(","id":"S","model":")" + name + version + R"("})");
    }
    if (engine() % 3 == 0) all.push_back(R"({"name":"X","id":"X"})");
    if (engine() % 4 == 0) all.push_back(R"({"name":"pressure"})");
    if (engine() % 3 == 0) all.push_back(R"({"name":"light","id":"L","model":)" + own_model(engine) + "}");
    std::string text;
    for (const auto& service : all)
        text += (text.empty() ? "" : ",") + service;
    return "[" + text + "]";
}

std::vector<OwnedMessage> bus_of(Engine& engine) {
    std::vector<OwnedMessage> all;
    for (int i = 0; i < 12; ++i) {
        const std::string board = "b" + std::to_string(i);
        if (i % 6 == 5) {
            all.push_back(board_name(board));
            all.push_back(service_name(board, one_of<std::string>(engine, {"servo", "distance", "strange"})));
            continue;
        }
        all.push_back(description(
            board, {.services = services(engine),
                    .chip = one_of<std::string>(engine, {"ATmega328P", "ATmega2560", ""}),
                    .capabilities = one_of<std::string>(engine, {"0011", "2", "0", "5"}),
                    .more = one_of<std::string>(
                        engine, {"", R"("labels":{"room":"lab"})", R"("labels":{"room":"hall","old":""})",
                                 R"("names":{"services":{"servo":"arm"}},"labels":{"floor":"2"})"})}));
        all.push_back(state(board, one_of<std::string>(engine, {"online", "offline", "sleeping", "lost"})));
    }
    return all;
}

bus::Query query_of(Engine& engine) {
    bus::Query query;
    query.limit = 1000;
    const auto sometimes = [&engine] { return engine() % 3 == 0; };
    if (sometimes()) query.board = one_of<std::string>(engine, {"b1*", "*2", "b?", "b3"});
    if (sometimes()) query.service = one_of<std::string>(engine, {"s*", "distance", "*e", "light"});
    if (sometimes()) query.kind = {one_of<std::string>(engine, {"servo", "X", "lamp", "none"}), "distance"};
    if (sometimes()) query.state = {one_of<std::string>(engine, {"online", "lost", "sleeping"}), "offline"};
    if (sometimes()) query.chip = one_of<std::string>(engine, {"ATmega*", "ATmega2560", "?"});
    if (sometimes()) query.sketch = one_of<std::string>(engine, {"AsipHello", "Other*"});
    if (sometimes())
        query.unit = one_of<std::string>(engine, {"cm", "degrees", "Hz", "lux", "ms", "furlongs"});
    if (sometimes())
        query.labels = *bus::LabelSelector::parse(
            one_of<std::string>(engine, {"room=lab", "room!=lab", "!old", "floor", "room,!old", "floor=3"}));
    if (sometimes()) query.capability = one_of<std::string>(engine, {"digital", "analog", "pwm"});
    return query;
}

std::string topic_of(const OwnedMessage& message) {
    const bus::Topics topics;
    switch (message.kind) {
        case bus::TopicKind::kDescription:
            return topics.description(message.board);
        case bus::TopicKind::kState:
            return topics.state(message.board);
        case bus::TopicKind::kServiceNames:
            return topics.service_names(message.board);
        default:
            return topics.board_names();
    }
}

std::string shown(const bus::Query& query) {
    return bus::encode(bus::RegistryRequest{query, {}, {}});
}

struct BothSides {
    explicit BothSides(Engine& engine) {
        Catalogue::Options options;
        options.units_of = [](std::string_view reference) { return model::units_of(models(), reference); };
        catalogue.emplace(options);
        for (const auto& message : bus_of(engine)) {
            catalogue->apply(message.view(), at(1s));
            reader.apply(topic_of(message), message.payload, false, at(1s));
        }
    }
    std::vector<std::string> boards_of_registry(bus::Query query) {
        query.find = bus::Find::kBoards;
        std::vector<std::string> names;
        const auto answer = catalogue->find(query, instant(at(2s)));
        if (!answer) return {answer.error()};
        for (const auto& board : answer->boards)
            names.push_back(board.board);
        return names;
    }
    std::vector<std::string> services_of_registry(bus::Query query) {
        query.find = bus::Find::kServices;
        std::vector<std::string> names;
        const auto answer = catalogue->find(query, instant(at(2s)));
        if (!answer) return {answer.error()};
        for (const auto& service : answer->services)
            names.push_back(service.board + "/" + service.name);
        std::sort(names.begin(), names.end());
        return names;
    }
    std::vector<std::string> boards_of_reader(const bus::Query& query) {
        std::vector<std::string> names;
        for (const auto& board : reader.boards(at(2s))) {
            if (bus::board_matches(query, board, reader.description(board.board), models()))
                names.push_back(board.board);
        }
        return names;
    }
    std::vector<std::string> services_of_reader(const bus::Query& query) {
        std::vector<std::string> names;
        for (const auto& board : reader.boards(at(2s))) {
            const auto* description = reader.description(board.board);
            if (!bus::board_matches(query, board, description, models())) continue;
            for (const auto& service : board.services) {
                if (bus::service_matches(query, service, description, models()))
                    names.push_back(board.board + "/" + service.name);
            }
        }
        std::sort(names.begin(), names.end());
        return names;
    }

    std::optional<Catalogue> catalogue;
    bus::Mirror reader{bus::Topics()};
};

TEST(QueryAgreement, RandomQueriesOverRandomBoards_RegistryAndReaderGiveTheSame) {
    int found = 0;
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        Engine engine(seed);
        BothSides both(engine);
        for (int i = 0; i < 60; ++i) {
            const auto query = query_of(engine);
            const auto boards = both.boards_of_reader(query);
            ASSERT_EQ(both.boards_of_registry(query), boards) << "seed " << seed << ": " << shown(query);
            ASSERT_EQ(both.services_of_registry(query), both.services_of_reader(query))
                << "seed " << seed << ": " << shown(query);
            found += boards.empty() ? 0 : 1;
        }
    }
    EXPECT_GT(found, 500) << "most queries must find something, else nothing is compared";
}

TEST(QueryAgreement, UnitOfACommandOnly_IsFoundByBoth) {
    Engine engine(1);
    BothSides both(engine);
    const auto servo = description("b99", {.services = R"([{"name":"servo","id":"S","model":"servo@1"}])"});
    both.catalogue->apply(servo.view(), at(1s));
    both.reader.apply(topic_of(servo), servo.payload, false, at(1s));
    bus::Query query;
    query.unit = "degrees";
    query.board = "b99";
    EXPECT_THAT(both.boards_of_registry(query), testing::ElementsAre("b99"));
    EXPECT_THAT(both.boards_of_reader(query), testing::ElementsAre("b99"));
}

}  // namespace
}  // namespace asip::registry
