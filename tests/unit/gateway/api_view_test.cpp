// SPDX-License-Identifier: Apache-2.0
// What a client with limited rights is told by any resource, page, number and cursor.
#include "api_bench.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// A lobby's screen shows the servo of board "mid"; there are boards before and behind it, in every order.
class ViewTest : public ApiTest {
  protected:
    explicit ViewTest(const std::string& base_path = {}) : ApiTest(Role::kNone, base_path) {
        gateway_->gate().set_tokens(*Tokens::parse(
            "kiosk lobby " + hash_of("lobby") + " boards=mid services=servo\n" + "viewer team " +
            hash_of("team") + " boards=mid,z*\n" + "viewer all " + hash_of("all") + "\nadmin boss " +
            hash_of("boss") + " until=2999-01-01T00:00:00.000Z\n"));
        for (const std::string board : {"alpha", "hidden", "mid", "zeta"})
            described(board, board == "mid" ? "Shown" : "Covert");
    }
    void described(const std::string& board, const std::string& sketch) {
        bus("asip/servicebus/" + board + "/$description",
            json{{"board", board},
                 {"session", "s1"},
                 {"seq", 1},
                 {"lease", 60},
                 {"firmware", {{"chip", board + "-chip"}, {"sketch", sketch}}},
                 {"labels", {{"room", board + "-room"}}},
                 {"names", {{"services", {{"distance", "covert name"}}}, {"pins", {{"13", "covert pin"}}}}},
                 {"services",
                  {{{"name", "distance"}, {"id", "D"}, {"model", "distance@1"}, {"title", "Distance"}},
                   {{"name", "servo"}, {"id", "S"}, {"model", "servo@1"}, {"title", "Servos"}}}}}
                .dump());
        bus("asip/servicebus/" + board + "/$state", board == "zeta" ? "offline" : "online");
        bus("asip/" + board + "/distance/out", R"({"distance":[371]})");
    }
    std::shared_ptr<Captured> as(const std::string& token, const std::string& target,
                                 std::vector<std::pair<std::string, std::string>> headers = {}) {
        headers.emplace_back("authorization", "Bearer " + token);
        return ask("GET", target, {}, std::move(headers));
    }
    /// All pages of a list, one item each, as they were sent, cursors too.
    std::string pages(const std::string& token, const std::string& target, std::size_t& items) {
        std::string all, cursor;
        for (int i = 0; i < 20; ++i) {
            const auto page =
                as(token, target + "limit=1" + (cursor.empty() ? "" : "&cursor=" + encoded(cursor)));
            EXPECT_EQ(page->status(), 200) << target << page->detail();
            all += std::string(page->response->text()) + "\n";
            const auto body = page->body();
            items += body["items"].size();
            cursor = body.value("cursor", "");
            if (cursor.empty()) return all;
        }
        ADD_FAILURE() << target << " has no end";
        return all;
    }
    static std::string encoded(const std::string& text) {
        std::string result;
        for (const char c : text) {
            constexpr const char* kDigits = "0123456789ABCDEF";
            result += '%';
            result += kDigits[static_cast<unsigned char>(c) >> 4];
            result += kDigits[c & 15];
        }
        return result;
    }
    static void says_nothing_hidden(const std::string& text, const std::string& of) {
        for (const char* hidden :
             {"alpha", "hidden", "zeta", "Covert", "covert", "distance", "371", "Distance"})
            EXPECT_THAT(text, Not(HasSubstr(hidden))) << of;
    }
};

TEST_F(ViewTest, EveryListInEveryOrder_SaysNothingOfWhatIsHidden_NotEvenInItsCursors) {
    for (const std::string list : {"boards", "services"}) {
        for (const std::string sort : {"name", "-name", "state", "-state", "chip", "-chip", "sketch",
                                       "-sketch", "last_seen", "-last_seen"}) {
            for (const std::string more : {"", "count=true&", "state=online&"}) {
                std::size_t items = 0;
                const auto target = "/api/" + list + "?sort=" + sort + "&" + more;
                const auto text = pages("lobby", target, items);
                EXPECT_EQ(items, 1u) << target << text;
                says_nothing_hidden(text, target);
            }
        }
    }
    for (const std::string form : {"full=true&", "brief=true&"}) {
        std::size_t items = 0;
        says_nothing_hidden(pages("lobby", "/api/boards?" + form, items), form);
        EXPECT_EQ(items, 1u) << form;
    }
}

TEST_F(ViewTest, PropertiesAndValues_AreThoseOfTheServicesThatAreSeen) {
    for (const std::string what : {"properties", "values"}) {
        const auto target = "/api/boards/mid/" + what;
        const auto seen = std::string(as("lobby", target)->response->text());
        EXPECT_THAT(seen, HasSubstr("servo/0/angle"));
        says_nothing_hidden(seen, target);
        EXPECT_EQ(as("lobby", target + "?ids=distance/0")->status(), 404);
        EXPECT_EQ(as("lobby", "/api/boards/alpha/" + what)->status(), 404);
    }
    const auto stream = as("lobby", "/api/boards/mid/values/stream");
    ASSERT_TRUE(stream->source);
    std::string told;
    stream->source->take(told, 65536);
    bus("asip/mid/distance/out", R"({"distance":[371]})");
    stream->source->take(told, 65536);
    EXPECT_THAT(told, HasSubstr("servo/0/angle"));
    says_nothing_hidden(told, "the stream");
    EXPECT_EQ(as("lobby", "/api/boards/alpha/values/stream")->status(), 404);
}

TEST_F(ViewTest, MeaningsOfHiddenServices_AreHidden) {
    bus("asip/servicebus/mid/$description",
        R"({"board":"mid","session":"s1","seq":2,"lease":60,"meanings":{"distance/0":{"icon":"covert"},)"
        R"("servo/0/angle":{"icon":"mdi:fan"}},"pin_modes":{"13":3},"services":[)"
        R"({"name":"distance","id":"D","model":"distance@1"},{"name":"servo","id":"S","model":"servo@1"}]})");
    const auto text = std::string(as("lobby", "/api/boards/mid")->response->text());
    EXPECT_THAT(text, HasSubstr("mdi:fan"));
    EXPECT_THAT(text, Not(HasSubstr("pin_modes")));
    says_nothing_hidden(text, "the board");
}

TEST_F(ViewTest, Totals_CountWhatIsSeen) {
    EXPECT_EQ(as("all", "/api/boards?count=true&limit=1")->body()["total"], 4);
    EXPECT_EQ(as("team", "/api/boards?count=true&limit=1")->body()["total"], 2);
    EXPECT_EQ(as("lobby", "/api/boards?count=true&limit=1")->body()["total"], 1);
    EXPECT_EQ(as("lobby", "/api/services?count=true&limit=1")->body()["total"], 1);
    EXPECT_EQ(as("lobby", "/api/boards?count=true&sort=-chip")->body()["total"], 1);
}

// A filter must not tell by what it finds that a hidden service is there.
TEST_F(ViewTest, FiltersOnHiddenServices_FindNothing) {
    for (const std::string filter : {"kind=distance", "service=dist*", "kind=distance&sort=-name"}) {
        EXPECT_EQ(as("all", "/api/boards?" + filter)->body()["items"].size(), 4u) << filter;
        EXPECT_EQ(as("lobby", "/api/boards?" + filter)->body()["items"].size(), 0u) << filter;
        EXPECT_EQ(as("lobby", "/api/services?" + filter)->body()["items"].size(), 0u) << filter;
    }
    EXPECT_EQ(as("lobby", "/api/boards?kind=servo")->body()["items"].size(), 1u);
}

TEST_F(ViewTest, OneBoard_IsShownWithoutItsHiddenServicesNamesAndPins) {
    says_nothing_hidden(std::string(as("lobby", "/api/boards/mid")->response->text()), "board");
    EXPECT_THAT(std::string(as("team", "/api/boards/mid")->response->text()), HasSubstr("covert pin"));
}

TEST_F(ViewTest, Status_OfALimitedToken_IsOfItsBoardsAlone) {
    bus("asip/registry/r1/state", "online");
    const auto all = as("all", "/api/status")->body();
    EXPECT_EQ(all["mirror"]["boards"], 4);
    EXPECT_TRUE(all["broker"].contains("address"));
    const auto lobby = as("lobby", "/api/status")->body();
    EXPECT_EQ(lobby["mirror"]["boards"], 1);
    EXPECT_EQ(lobby["broker"]["connected"], true);
    EXPECT_FALSE(lobby["broker"].contains("address")) << "where the broker is";
    EXPECT_FALSE(lobby.contains("registries"));
    EXPECT_FALSE(lobby.contains("streams"));
    for (const auto* name : {"exports", "simulator", "users"})
        EXPECT_FALSE(lobby.contains(name)) << name;
    EXPECT_EQ(
        all["exports"][0].dump(),
        R"({"found":true,"on":true,"other":"cellar","shows":false,"system":"home-assistant","title":"Home Assistant"})");
    EXPECT_EQ(all["simulator"], false);
    EXPECT_FALSE(all.contains("users")) << "for an admin";
    const auto users = as("boss", "/api/status")->body()["users"];
    ASSERT_EQ(users.size(), 4u);
    EXPECT_EQ(users[0].dump(), R"({"boards":["mid"],"name":"lobby","role":"kiosk","services":["servo"]})");
    EXPECT_EQ(users[3]["until"], "2999-01-01T00:00:00.000Z");
    EXPECT_EQ(lobby["you"]["command"], false);
    EXPECT_EQ(lobby["you"]["limited"], true);
    EXPECT_EQ(as("team", "/api/status")->body()["mirror"]["boards"], 2);
}

TEST_F(ViewTest, Models_OfServicesThatAreNotSeen_AreNotThere) {
    const auto models = as("lobby", "/api/models")->body()["items"];
    ASSERT_EQ(models.size(), 1u);
    EXPECT_EQ(models[0]["name"], "servo");
    EXPECT_EQ(as("lobby", "/api/models/distance")->status(), 404);
    EXPECT_EQ(as("lobby", "/api/models/servo")->status(), 200);
    EXPECT_GT(as("all", "/api/models")->body()["items"].size(), 2u);
}

TEST_F(ViewTest, Metrics_CountWhatIsSeen) {
    const auto text = std::string(as("team", "/metrics")->response->text());
    EXPECT_THAT(text, HasSubstr("asip_boards{state=\"online\"} 1\n"));
    EXPECT_THAT(text, HasSubstr("asip_boards{state=\"offline\"} 1\n"));
    EXPECT_THAT(text, HasSubstr("asip_services{asip_service=\"servo\"} 2\n"));
    EXPECT_EQ(as("lobby", "/metrics")->status(), 403);
    bus("asip/servicebus/alpha/$state", "lost");
    bus("asip/servicebus/zeta/$state", "lost");
    EXPECT_THAT(std::string(as("all", "/metrics")->response->text()),
                AllOf(HasSubstr("asip_boards_lost{reason=\"agent-gone\"} 2\n"),
                      HasSubstr("asip_boards_lost{reason=\"unplugged\"} 0\n")));
    EXPECT_THAT(std::string(as("team", "/metrics")->response->text()),
                HasSubstr("asip_boards_lost{reason=\"agent-gone\"} 1\n"));
}

TEST_F(ViewTest, BoardFromTheBox_IsCountedApartAndNotAsLost) {
    const auto silent = [this](const std::string& board, const std::string& chip) {
        bus("asip/servicebus/" + board + "/$description",
            R"({"board":")" + board + R"(","session":"a","seq":1,"lease":60,"firmware":{"chip":")" + chip +
                R"("},"link":{"kind":"serial","path":"/dev/x"},"state":{"is":"lost","reason":"silent","age":0},)"
                R"("services":[]})");
        bus("asip/servicebus/" + board + "/$state", "lost");
    };
    silent("box1", "");
    silent("box2", "");
    silent("hung", "ATmega328P");
    EXPECT_THAT(
        std::string(as("all", "/metrics")->response->text()),
        AllOf(HasSubstr("asip_boards{state=\"no-asip\"} 2\n"), HasSubstr("asip_boards{state=\"lost\"} 1\n"),
              HasSubstr("asip_boards_lost{reason=\"silent\"} 1\n")));
}

TEST_F(ViewTest, ValuesInMetrics_AreThoseThatAreSeen) {
    const auto text = std::string(as("team", "/metrics?values=*/*")->response->text());
    EXPECT_THAT(text, HasSubstr("asip_value{board=\"mid\",property=\"distance/0\"}"));
    EXPECT_THAT(text, Not(HasSubstr("alpha")));
    EXPECT_THAT(std::string(as("all", "/metrics?values=alpha/*")->response->text()),
                HasSubstr("asip_value{board=\"alpha\""));
}

TEST_F(ViewTest, StreamsSnapshotsAndChanges_SayNothingHidden) {
    const auto events = as("lobby", "/api/events");
    std::string text;
    for (int i = 0; i < 20; ++i)
        events->source->take(text, 100'000);
    for (const std::string board : {"alpha", "zeta", "mid"})
        bus("asip/servicebus/" + board + "/$state", "sleeping");
    for (int i = 0; i < 5; ++i)
        events->source->take(text, 100'000);
    EXPECT_THAT(text, HasSubstr("snapshot-end"));
    EXPECT_THAT(text, HasSubstr("event: state"));
    says_nothing_hidden(text, "events");
}

TEST_F(ViewTest, UnknownName_NamesOnlyWhatIsSeen) {
    says_nothing_hidden(as("lobby", "/api/boards/mide")->detail(), "a name that is nearly one");
    EXPECT_THAT(as("lobby", "/api/boards/zet")->detail(), Not(HasSubstr("zeta")));
    EXPECT_EQ(as("lobby", "/api/boards/mid/services/distance/value?wait=1")->status(), 404);
}

TEST_F(ViewTest, HistoryOfManyPatterns_GoesOnUntilThePageIsFullOrAllWasLookedAt) {
    const auto history = as("team", "/api/history?limit=2");
    EXPECT_EQ(json::parse(published_.back().payload)["limit"], 2);
    answer(
        R"({"find":"history","cursor":"70","items":[{"board":"alpha","what":"added"},{"board":"mid","what":"added"}]})");
    ASSERT_EQ(history->status(), 0) << "one of two is not enough";
    EXPECT_EQ(json::parse(published_.back().payload)["cursor"], "70");
    EXPECT_EQ(json::parse(published_.back().payload)["limit"], 1);
    answer(R"({"find":"history","cursor":"60","items":[{"board":"zeta","what":"added"}]})");
    ASSERT_EQ(history->status(), 200);
    ASSERT_EQ(history->body()["items"].size(), 2u);
    EXPECT_EQ(history->body()["items"][1]["board"], "zeta");
    EXPECT_EQ(history->body()["cursor"], "60");
}

TEST_F(ViewTest, HistoryOfOnePattern_IsAskedForAsThat) {
    as("lobby", "/api/history");
    EXPECT_EQ(json::parse(published_.back().payload)["board"], "mid");
}

TEST_F(ViewTest, ETag_IsOfTheRights) {
    const auto etag = as("all", "/api/boards")->header("ETag");
    EXPECT_EQ(as("all", "/api/boards", {{"if-none-match", etag}})->status(), 304);
    for (const std::string target : {"/api/boards", "/api/services", "/api/boards/mid"}) {
        const auto of_all = as("all", target)->header("ETag");
        const auto lobby = as("lobby", target, {{"if-none-match", of_all}});
        EXPECT_EQ(lobby->status(), 200) << "304 would be another one's list: " << target;
        EXPECT_NE(lobby->header("ETag"), of_all);
        EXPECT_EQ(as("lobby", target, {{"if-none-match", lobby->header("ETag")}})->status(), 304);
        EXPECT_EQ(lobby->header("Cache-Control"), "private, no-cache") << target;
        EXPECT_EQ(lobby->header("Vary"), "Authorization, Cookie") << target;
    }
}

/// Many boards, of which a token shows one.
class ManyBoards : public ViewTest {
  protected:
    ManyBoards() {
        for (int i = 0; i < kBoards; ++i)
            described("board" + std::to_string(10'000 + i), "Covert");
    }
    /// Turns until the snapshot is over, and the longest text of one.
    int turns(http::Source& source, std::string& all, std::size_t& longest) {
        for (int turn = 1; turn < 1000; ++turn) {
            std::string text;
            source.take(text, 16 * 1024);
            longest = std::max(longest, text.size());
            all += text;
            if (text.find("snapshot-end") != std::string::npos) return turn;
            EXPECT_TRUE(!text.empty() || source.more()) << "it would wait for nothing";
        }
        return -1;
    }
    static constexpr int kBoards = 2000;
};

TEST_F(ManyBoards, SnapshotOfALimitedToken_LooksAtFewNamesATurnAndAsksForTheNext) {
    const auto stream = as("lobby", "/api/events");
    std::string text;
    std::size_t longest = 0;
    const int took = turns(*stream->source, text, longest);
    EXPECT_GE(took, kBoards / 500) << "others have their turn between";
    EXPECT_LE(took, kBoards / 500 + 5);
    EXPECT_EQ(text.find("board1"), std::string::npos);
    EXPECT_THAT(text, HasSubstr("\"board\":\"mid\""));
}

TEST_F(ManyBoards, SnapshotOfAll_IsMadePieceByPiece) {
    const auto stream = as("all", "/api/events");
    std::string text;
    std::size_t longest = 0;
    EXPECT_GT(turns(*stream->source, text, longest), 10);
    EXPECT_LT(longest, 40'000u);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n') > kBoards * 3, true);
}

}  // namespace
}  // namespace asip::gateway
