// SPDX-License-Identifier: Apache-2.0
// What must hold whatever arrives: nothing breaks the invariants, and the indices answer as a full scan
// would. truth_presence tries orders, repetitions and two agents of one name.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "asip/bus/pattern.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "bus_messages.hpp"
#include "tests/support/catalogue_check.hpp"

namespace asip::catalogue {
namespace {

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t bound) {
    return random() % bound;
}

std::string services_text(Random& random) {
    static const std::vector<std::string> kKinds{"io", "distance", "servo", "bump", "encoders", "F"};
    std::string text;
    for (const std::string& kind : kKinds) {
        if (below(random, 2) == 0) continue;
        text += (text.empty() ? "" : ",") +
                (R"({"name":")" + kind + R"(","model":")" + kind + R"(@1","count":)") +
                std::to_string(below(random, 3)) + "}";
    }
    return "[" + text + "]";
}

OwnedMessage anything(Random& random) {
    const std::string board = "b" + std::to_string(below(random, 12));
    static const std::vector<std::string> kStates{"online",   "offline", "lost", "sleeping",
                                                  "updating", "",        "dead"};
    OwnedMessage message;
    switch (below(random, 10)) {
        case 0:
            message = state(board, kStates[below(random, kStates.size())]);
            break;
        case 1:
            message = board_name(below(random, 9) == 0 ? "a/b" : board);
            break;
        case 2:
            message = service_name(board, "s" + std::to_string(below(random, 5)));
            break;
        case 3:
            message = traffic(board);
            break;
        case 4: {
            message = description(board);
            message.payload[below(random, message.payload.size())] = static_cast<char>(random());
            break;
        }
        default:
            message =
                description(board, {.session = std::string(1, static_cast<char>('a' + below(random, 5))),
                                    .seq = below(random, 30),
                                    .services = services_text(random),
                                    .lease = static_cast<int>(below(random, 40)),
                                    .chip = below(random, 2) == 0 ? "ATmega328P" : "ESP32",
                                    .capabilities = below(random, 2) == 0 ? "001" : "127"});
    }
    message.retained = below(random, 4) == 0;
    if (below(random, 2) == 0) message.expiry_seconds = static_cast<std::uint32_t>(below(random, 60));
    return message;
}

std::vector<bus::Query> all_kinds_of_queries() {
    std::vector<bus::Query> queries;
    for (const bus::Find find : {bus::Find::kBoards, bus::Find::kServices}) {
        for (const char* sort : {"name", "-name", "state", "-chip", "last_seen"}) {
            bus::Query query;
            query.find = find;
            query.sort = sort;
            queries.push_back(query);
            query.kind = {"distance"};
            query.state = {"online"};
            queries.push_back(query);
            query.kind = {"distance", "io", "nothing"};
            query.state = {"online", "lost"};
            queries.push_back(query);
            query.kind.clear();
            query.board = "b1*";
            query.chip = "ESP*";
            queries.push_back(query);
            query.state.clear();
            query.chip.clear();
            query.board.clear();
            query.capability = "analog";
            query.service = "?o*";
            queries.push_back(query);
            query.capability.clear();
            query.service.clear();
            query.unit = "cm";
            queries.push_back(query);
        }
    }
    return queries;
}

/// Whether an item should be found, by its own members alone.
bool wanted(const bus::Query& query, const bus::BoardItem& board, const bus::ServiceItem* service) {
    const auto among = [](const std::vector<std::string>& list, const std::string& word) {
        return list.empty() || std::find(list.begin(), list.end(), word) != list.end();
    };
    if (!among(query.state, board.state) || !bus::matches_pattern(query.board, board.board) ||
        !bus::matches_pattern(query.chip, board.chip)) {
        return false;
    }
    if (!query.capability.empty() && board.description.find(R"("capabilities":"127")") == std::string::npos)
        return false;
    const auto service_wanted = [&](const bus::ServiceItem& item) {
        return among(query.kind, item.kind) && bus::matches_pattern(query.service, item.name) &&
               (query.unit.empty() || item.kind == "distance");
    };
    if (service != nullptr) return service_wanted(*service);
    if (query.kind.empty() && query.service.empty() && query.unit.empty()) return true;
    return std::any_of(board.services.begin(), board.services.end(), service_wanted);
}

std::vector<std::string> names_of(const bus::Answer& answer) {
    std::vector<std::string> names;
    for (const auto& item : answer.boards)
        names.push_back(item.board);
    for (const auto& item : answer.services)
        names.push_back(item.board + "/" + item.name);
    return names;
}

void expect_indices_answer_like_a_scan(Catalogue& catalogue, Instant now, Random& random) {
    bus::Query everything;
    everything.limit = 1000;
    everything.full = true;
    const auto scan = catalogue.find(everything, now);
    ASSERT_TRUE(scan);
    for (bus::Query query : all_kinds_of_queries()) {
        std::vector<std::string> expected;
        for (const auto& board : scan->boards) {
            if (query.find == bus::Find::kBoards) {
                if (wanted(query, board, nullptr)) expected.push_back(board.board);
                continue;
            }
            for (const auto& service : board.services)
                if (wanted(query, board, &service)) expected.push_back(board.board + "/" + service.name);
        }
        std::vector<std::string> found;
        query.limit = 1 + below(random, 7);
        query.count = below(random, 2) == 0;
        for (int page = 0; page < 200; ++page) {
            const auto answer = catalogue.find(query, now);
            ASSERT_TRUE(answer) << answer.error();
            const auto names = names_of(*answer);
            found.insert(found.end(), names.begin(), names.end());
            ASSERT_TRUE(answer->total || !query.count);
            ASSERT_EQ(answer->total.value_or(expected.size()), expected.size())
                << bus::encode({query, "", ""});
            query.cursor = answer->cursor;
            if (query.cursor.empty()) break;
        }
        if (query.sort == "name") {
            std::sort(expected.begin(), expected.end());
        } else {
            std::sort(expected.begin(), expected.end());
            std::sort(found.begin(), found.end());
        }
        ASSERT_EQ(found, expected) << bus::encode({query, "", ""});
    }
}

TEST(CatalogueProperty, RandomInput_BreaksNoInvariantAndIndicesAgreeWithAScan) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        Random random(seed);
        Catalogue catalogue({.forget_after = 50s, .units_of = [](std::string_view model) {
                                 return model == "distance@1" ? std::vector<std::string>{"cm"}
                                                              : std::vector<std::string>{};
                             }});
        Time now = at(0s);
        std::uint64_t seq = 0;
        const auto numbered = [&](const std::vector<Event>& events) {
            for (const Event& event : events) {
                seq += event.is_change() ? 1 : 0;
                ASSERT_EQ(event.seq, event.is_change() ? seq : 0);
            }
        };
        for (int step = 0; step < 600; ++step) {
            now += std::chrono::milliseconds(below(random, 2500));
            if (below(random, 4) != 0) numbered(catalogue.expire(now));
            if (below(random, 60) == 0) catalogue.suspend();
            if (catalogue.suspended() && below(random, 3) == 0) catalogue.resume(now);
            if (below(random, 30) == 0) {
                if (auto events = catalogue.forget("b" + std::to_string(below(random, 12)), now))
                    numbered(*events);
            }
            const OwnedMessage message = anything(random);
            numbered(catalogue.apply(message.view(), now).events);
            if (below(random, 8) == 0) catalogue.settle();
            ASSERT_EQ(CatalogueCheck::check(catalogue), "") << "seed " << seed << " step " << step;
            if (step % 50 == 49) expect_indices_answer_like_a_scan(catalogue, instant(now), random);
        }
        ASSERT_EQ(catalogue.seq(), seq);
        catalogue.resume(now);
        numbered(catalogue.expire(now + 24h * 3));
        numbered(catalogue.expire(now + 24h * 6));
        ASSERT_EQ(catalogue.size(), 0u) << "without news everything is forgotten in the end";
        ASSERT_EQ(CatalogueCheck::check(catalogue), "");
    }
}

}  // namespace
}  // namespace asip::catalogue
