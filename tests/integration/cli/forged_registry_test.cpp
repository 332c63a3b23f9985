// SPDX-License-Identifier: Apache-2.0
// Answers and counters that a registry would never write: anybody on an open bus may.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "asip/text/printable.hpp"
#include "tests/integration/cli/bus_fixture.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ForgedRegistryTest : public BusTest {
  protected:
    using Page = std::function<std::string(int number)>;

    /// asipctl, while a program that calls itself r1 answers each of its queries.
    Finished answered_by(const Page& page, const Words& words) {
        probe_.clear();
        ChildProcess child(program(words), environment());
        std::size_t seen = 0;
        int number = 0;
        Finished finished;
        wait_until([&] {
            const auto messages = probe_.messages();
            for (; seen < messages.size(); ++seen)
                if (messages[seen].topic == "asip/registry/query" ||
                    messages[seen].topic == "asip/registry/r1/query")
                    answer(messages[seen], page(number++));
            return !child.running();
        });
        return {child.wait_exit(0s).value_or(-1), child.output(), child.errors()};
    }
};

std::string page_with(const std::string& members, const std::string& items) {
    return R"({"registry":"r1","epoch":"e","seq":1,)" + members + R"("items":[)" + items + "]}";
}

/// As on another node of a cluster, which has nothing of what it retains.
TEST_F(ForgedRegistryTest, RegistryThatRetainsNothing_IsFoundByTheDoctor) {
    const auto doctor = answered_by([](int) { return page_with(R"("total":0,)", ""); }, {"doctor"});
    EXPECT_THAT(doctor.output, HasSubstr("ok       registry r1 answers"));
    EXPECT_THAT(doctor.output, Not(HasSubstr("no registry runs")));
}

TEST_F(ForgedRegistryTest, BoardThatComesBehindTheQuestion_IsTaken) {
    probe_.publish("asip/registry/r1/$state", "online", true);
    ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    const auto late = [](bool stays) {
        return [stays](int number) {
            const bool there = number == 1 || (stays && number > 1);
            return page_with(R"("find":"boards",)", there ? R"({"board":"desk","state":"online"})" : "");
        };
    };
    const auto show = answered_by(late(true), {"show", "desk"});
    EXPECT_EQ(show.status, 0) << show.errors;
    EXPECT_THAT(show.output, HasSubstr("desk  online"));
    const auto gone = answered_by(late(false), {"show", "desk"});
    EXPECT_EQ(gone.status, 4);
    EXPECT_THAT(gone.errors, HasSubstr("no board 'desk'"));
    EXPECT_THAT(gone.errors, Not(HasSubstr("did you mean")));
}

TEST_F(BusTest, DescriptionWithAModelThatIsNotValid_IsShownWithWhatIsWrong) {
    const std::string description =
        R"({"board":"esp","session":"a","seq":1,"services":[{"name":"x","model":{"name":"x"}}]})";
    probe_.publish("asip/servicebus/esp/$description", description, true);
    probe_.publish("asip/servicebus/esp/$state", "online", true);
    ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    const auto expect_told = [this](const Words& more) {
        Words words{"show", "esp"};
        words.insert(words.end(), more.begin(), more.end());
        const auto show = asipctl(words);
        EXPECT_THAT(show.output, HasSubstr("a description that is not valid: /services/0/model"));
        EXPECT_THAT(show.output, Not(HasSubstr("publishes no description")));
        EXPECT_EQ(show.status, 0) << show.errors;
    };
    expect_told({"--from-bus"});
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online"));
    expect_told({});
    const auto json = nlohmann::json::parse(asipctl({"show", "esp", "-o", "json"}).output);
    EXPECT_THAT(json.value("description_fault", ""), HasSubstr("model"));
    EXPECT_THAT(asipctl({"label", "esp", "room=lab"}).errors, HasSubstr("not valid: /services/0/model"));
}

TEST_F(ForgedRegistryTest, PagesWithoutAnEnd_AreRefused) {
    const std::string service = R"({"board":"uno1","name":"io","state":"online"})";
    const std::string change = R"({"board":"uno1","at":"2099-01-01T00:00:00.000Z","what":"added"})";
    const struct {
        Words words;
        std::string find, item;
    } cases[] = {{{"list"}, R"("find":"boards","brief":true,)", R"(["uno1","online",1,"","",""])"},
                 {{"list", "-o", "json"}, R"("find":"boards",)", R"({"board":"uno1","state":"online"})"},
                 {{"list", "-o", "jsonl"}, R"("find":"boards",)", R"({"board":"uno1","state":"online"})"},
                 {{"list", "services"}, R"("find":"services",)", service},
                 {{"events", "--last", "1000"}, R"("find":"history",)", change},
                 {{"events", "--since", "7d"}, R"("find":"history",)", change}};
    for (const auto& one : cases) {
        const auto repeated = [&](int) { return page_with(one.find + R"("cursor":"c",)", one.item); };
        const auto empty = [&](int number) {
            const auto cursor = R"("cursor":")" + std::to_string(number) + "\",";
            return page_with(one.find + cursor, number == 0 ? one.item : "");
        };
        const auto nothing = [&](int number) {
            return page_with(one.find + R"("cursor":")" + std::to_string(number) + "\",", "");
        };
        for (const Page& page : {Page(repeated), Page(empty), Page(nothing)}) {
            const auto ended = answered_by(page, one.words);
            EXPECT_EQ(ended.status, 1) << testing::PrintToString(one.words) << ended.errors;
            EXPECT_THAT(ended.errors, HasSubstr("the answer of registry r1 has no end"));
        }
    }
}

TEST_F(ForgedRegistryTest, TextsAndNames_MoveNoCursor) {
    const std::string evil = "e\u009b2J\\u001b[2J\u202e\x7f";
    const auto brief = [&](int) {
        return page_with(
            R"("find":"boards","brief":true,)",
            "[\"" + evil + R"(","online",1,"","",""],["uno1",")" + evil + R"(",1,")" + evil + R"(","",""])");
    };
    const auto whole = [&](int) {
        const auto board = [&](const std::string& name) {
            return R"({"board":")" + name + R"(","state":")" + evil + R"(","chip":")" + evil +
                   R"(","services":[{"name":")" + evil + R"("}]})";
        };
        return page_with(R"("find":"boards",)", board("uno1") + "," + board(evil));
    };
    const auto services = [&](int) {
        return page_with(R"("find":"services",)", R"({"board":"uno1","name":")" + evil +
                                                      R"("},{"board":"uno1","name":"io","title":")" + evil +
                                                      "\"}");
    };
    for (const auto& [words, page] :
         std::vector<std::pair<Words, Page>>{{{"list"}, brief},
                                             {{"list", "-o", "name"}, brief},
                                             {{"list", "-o", "wide"}, whole},
                                             {{"list", "-o", "json"}, whole},
                                             {{"list", "-o", "jsonl"}, whole},
                                             {{"list", "--sort", "state", "-o", "jsonl"}, whole},
                                             {{"list", "--format", "{board} {chip} {state}"}, whole},
                                             {{"list", "services", "-o", "name"}, services},
                                             {{"list", "services", "-o", "json"}, services},
                                             {{"list", "services"}, services}}) {
        const auto ended = answered_by(page, words);
        EXPECT_EQ(ended.status, 0) << ended.errors;
        EXPECT_THAT(ended.output, HasSubstr("uno1")) << testing::PrintToString(words);
        for (const auto& text : {ended.output, ended.errors}) {
            EXPECT_EQ(text, text::escape_json(text)) << testing::PrintToString(words);
            EXPECT_EQ(text.find('\x1b'), std::string::npos) << testing::PrintToString(words);
        }
    }
}

TEST_F(ForgedRegistryTest, NumbersBeyondAllMeasure_AreShownAsSuch) {
    const auto brief = [](int) {
        return page_with(R"("find":"boards","brief":true,)", R"(["uno1","online",1e308,"","",""])");
    };
    EXPECT_THAT(answered_by(brief, {"list"}).output, HasSubstr("over 100 years ago"));
    const auto whole = [](int) {
        return page_with(R"("find":"boards",)",
                         R"({"board":"uno1","state":"online","age":1e308,"lease":1e308,"services":[],)"
                         R"("last_seen":"2026-01-01T00:00:00.000Z"})");
    };
    EXPECT_THAT(answered_by(whole, {"list", "-o", "wide"}).output, HasSubstr("over 100 years ago"));
    const auto record = nlohmann::json::parse(answered_by(whole, {"list", "-o", "json"}).output)[0];
    EXPECT_EQ(record["age"], 1e12);
    EXPECT_EQ(record["lease"], 1'000'000'000'000);
}

}  // namespace
}  // namespace asip::test
