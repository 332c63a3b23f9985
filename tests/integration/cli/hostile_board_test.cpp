// SPDX-License-Identifier: Apache-2.0
// Every verb beside a board, a gateway and a file whose every text tries to take over the terminal.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "asip/model/model_set.hpp"
#include "asip/text/printable.hpp"
#include "cli/verb.hpp"
#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Clears the screen, paints, names the window, rings, sends C1 and DEL, begins a line and turns its order.
const std::string kEvil = "e\x1b[2J\x1b[31mred\x1b]0;x\x07\u009b2J\x7f\u202e\rz\nEVIL LINE";

/// What a description may hold: one with control characters counts for none.
const std::string kTurned = "[31mred\u202e";

std::string without_own_colours(std::string text) {
    for (const std::string code : {"0", "1", "2", "31", "32", "33", "36"}) {
        const auto sequence = "\x1b[" + code + "m";
        for (auto at = text.find(sequence); at != std::string::npos; at = text.find(sequence))
            text.erase(at, sequence.size());
    }
    return text;
}

void expect_harmless(const std::string& shown, const std::string& of, bool colour) {
    EXPECT_THAT(shown, Not(HasSubstr("\x1b[31mred"))) << of;
    std::istringstream lines(colour ? without_own_colours(shown) : shown);
    for (std::string line; std::getline(lines, line);) {
        EXPECT_TRUE(text::is_showable(line)) << of << ": " << text::printable(line, 500);
        EXPECT_THAT(line, Not(HasSubstr("\u202e"))) << of;
        EXPECT_FALSE(line.starts_with("EVIL LINE")) << of << ": " << text::printable(shown, 2000);
    }
}

/// Answers whatever is asked of the board, each time in another way, until it goes.
std::string answer_number(std::size_t number) {
    switch (number % 4) {
        case 0:
            return nlohmann::json{{"status", "error"}, {"code", 4}, {"error", kEvil}}.dump();
        case 1:
            return nlohmann::json{{"status", "refused"}, {"reason", kEvil}, {"error", kEvil}}.dump();
        case 2:
            return nlohmann::json{{"status", "ok"}, {"proof", "answer"}, {"answer", kEvil}}.dump();
        default:
            return "{\n\"status\":\"ok\",\"proof\":\"answer\",\"answer\":{\"executed\":[5],\"a\":\n" +
                   nlohmann::json(kEvil).dump() + "}}";
    }
}

std::string hostile_description() {
    auto document = nlohmann::json::parse(cli::kUno1);
    auto model = nlohmann::json::parse(model::ModelSet::standard().find("servo")->source);
    model["name"] = "evilkind";
    model["id"] = "V";
    model["title"] = kTurned;
    model.erase("match");
    model["commands"]["write"]["title"] = kTurned;
    document["board"] = "evil";
    for (const char* member : {"sketch", "chip"})
        document["firmware"][member] = kTurned;
    document["link"]["path"] = kTurned;
    for (const char* member : {"version", "host", "client"})
        document["agent"][member] = kTurned;
    document["labels_fault"] = kTurned;
    document["services"].push_back({{"name", "evilkind"}, {"id", "V"}, {"model", model}, {"title", kTurned}});
    document["services"].push_back({{"name", "K"}, {"id", "K"}, {"title", kTurned}});
    return document.dump();
}

bool is_endless(const std::vector<std::string>& words) {
    const std::set<std::string> follow{"subscribe"};
    const auto has = [&words](const char* word) { return std::count(words.begin(), words.end(), word) != 0; };
    return follow.contains(words.front()) || has("--logs");
}

/// What answers each request with the same hostile text.
constexpr const char* kHostileGateway = R"(
import http.server, json, sys
class Hostile(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        body = json.dumps({"code": sys.argv[1], "detail": sys.argv[1]}).encode()
        self.send_response(404 if "404" in self.path else 200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)
    do_POST = do_GET
    def log_message(self, *of): pass
server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Hostile)
print("port", server.server_port, "is open", flush=True)
server.serve_forever()
)";

/// A quarter of the verbs a test: a verb takes the patience of all its questions to a board that never
/// answers well.
constexpr std::size_t kParts = 4;

class HostileBoardTest : public BusTest, public ::testing::WithParamInterface<std::size_t> {
  protected:
    void SetUp() override {
        probe_.publish("asip/servicebus/evil/$description", hostile_description(), true);
        probe_.publish("asip/servicebus/evil/$state", "online", true);
        const auto text = nlohmann::json(kEvil).dump();
        probe_.publish("asip/evil/$links",
                       R"({"version":1,"board":"evil","links":[{"name":"warm","from":"desk/io/2",)"
                       R"("when":"follows","to":"io/13","user":"ann","last":)" +
                           text + R"(,"fault":)" + text + "}]}",
                       true);
        ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    }

    /// Reports, answers and log lines as they come from a board that is under attack.
    void talk() {
        const auto messages = asked_.messages();
        for (; answered_ < messages.size(); ++answered_)
            if (!messages[answered_].response_topic.empty())
                answer(messages[answered_], answer_number(answered_));
        const auto now = std::chrono::steady_clock::now();
        if (now - reported_ < 50ms) return;
        reported_ = now;
        const auto evil = nlohmann::json(kEvil).dump();
        probe_.publish("asip/evil/out", "!" + kEvil);
        probe_.publish("asip/evil/out", "~D,4,2," + kEvil);
        probe_.publish("asip/evil/distance/out", R"({"distance":[)" + evil + "]}");
        probe_.publish("asip/evil/K/out", R"({"tag":"k","body":)" + evil + "}");
        probe_.publish("asip/evil/K/out", kEvil);
        probe_.publish("asip/evil/K/error", R"({"code":1,"text":)" + evil + "}");
        probe_.publish("asip/servicebus/evil/$log", R"({"level":)" + evil + R"(,"text":)" + evil + "}");
        probe_.publish("asip/servicebus/evil/$stats", R"({"trip_ms":)" + evil + "}");
        probe_.publish("asip/servicebus/evil/$commands", R"({"by":)" + evil + R"(,"command":)" + evil + "}");
        probe_.publish("asip/registry/r1/events", R"({"event":)" + evil + R"(,"board":)" + evil + "}");
    }

    /// All at the same time, with and without colours, while the board talks. What does not end by
    /// itself is interrupted once it wrote something.
    void expect_harmless_words(const std::vector<Words>& all) {
        struct Tried {
            std::string what;
            bool endless;
            bool colour;
            std::unique_ptr<ChildProcess> child;
        };
        auto variables = environment();
        variables["ASIP_TIMEOUT"] = "400ms";
        variables["HOME"] = variables["XDG_CONFIG_HOME"] = folder_.path().string();
        const auto input = folder_.write("input", "evil/servo write 0 90\nget K\n" + kEvil + "\n");
        std::vector<Tried> tried;
        for (auto words : all) {
            for (const bool colour : {false, true}) {
                if (colour) words.insert(words.end(), {"--color", "always"});
                Words reading{"bash", "-c", R"(file=$1; shift; exec "$@" < "$file")", "bash", input};
                reading.push_back(program_to_start(program({}).front()));
                reading.insert(reading.end(), words.begin(), words.end());
                tried.push_back({::testing::PrintToString(words), is_endless(words), colour,
                                 std::make_unique<ChildProcess>(reading, variables)});
            }
        }
        const auto done = [](const Tried& one) {
            return !one.child->running() || (one.endless && !one.child->output().empty());
        };
        EXPECT_TRUE(wait_until([&] {
            talk();
            return std::all_of(tried.begin(), tried.end(), done);
        }));
        for (auto& one : tried) {
            if (one.endless) one.child->signal(SIGINT);
            const auto status = one.child->wait_exit();
            ASSERT_TRUE(status) << one.what;
            EXPECT_NE(*status, 128 + SIGABRT) << one.what << "\n" << one.child->errors();
            expect_harmless(one.child->output(), one.what, one.colour);
            expect_harmless(one.child->errors(), one.what, one.colour);
            for (const auto& text : {one.child->output(), one.child->errors()})
                if (text.find("[31mred") != std::string::npos) showed_it_.insert(all.front().front());
        }
    }

    TempDir folder_;
    std::set<std::string> showed_it_{};  ///< verbs that did show what the board says

  private:
    BusProbe asked_{broker_.port(),
                    {"asip/evil/in", "asip/evil/+/in", "asip/evil/$stop", "asip/registry/query",
                     "asip/registry/+/query"}};
    std::size_t answered_ = 0;
    std::chrono::steady_clock::time_point reported_{};
};

TEST_P(HostileBoardTest, WhicheverVerb_WritesNoControlCharacter) {
    ChildProcess gateway({"python3", "-c", kHostileGateway, kEvil});
    const auto port = gateway.wait_for_output("port [0-9]+ is open");
    ASSERT_TRUE(port) << gateway.errors();
    const auto address = "http://127.0.0.1:" + port->substr(5, port->find(' ', 5) - 5);
    const auto model = folder_.write("evil.json", R"({"name":")" + kEvil + "\"}");
    const auto image = folder_.write("evil.hex", ":" + kEvil);
    const std::map<std::string, std::vector<Words>> tried{
        {"list",
         {{"list"},
          {"list", "-o", "wide"},
          {"list", "services"},
          {"list", "-o", "json"},
          {"list", "-o", "name"},
          {"list", "--format", "{board} {agent} {labels}"}}},
        {"show", {{"show", "evil"}, {"show", "evil/K"}, {"show", "evil/evilkind"}, {"show", "torn"}}},
        {"get",
         {{"get", "evil"},
          {"get", "evil/K"},
          {"get", "evil/distance"},
          {"get", "*/distance"},
          {"get", "evil/K", "--raw"}}},
        {"subscribe",
         {{"subscribe", "evil"},
          {"subscribe", "evil", "-o", "jsonl"},
          {"subscribe", "evil", "--format", "{service} {value}"}}},
        {"send",
         {{"send", "evil/servo", "write", "0", "90"},
          {"send", "evil", "--raw", "S,W,0,9"},
          {"send", "evil/K", "--raw", "k"},
          {"send", "evil/evilkind", "write", "0", "90"},
          {"send", "*/servo", "write", "0", "90"},
          {"send", "--stdin"},
          {"send", "evil/servo", "write", "0", "90", "-o", "json"}}},
        {"resume", {{"resume", "evil"}, {"resume", "--all"}}},
        {"stop", {{"stop", "evil"}, {"stop", "--all"}, {"stop", "evil", "--once", "-o", "json"}}},
        {"label",
         {{"label", "evil"},
          {"label", "evil", "room=lab"},
          {"label", "evil", "name=x"},
          {"label", "evil", "pin.D13=lamp"},
          {"label"}}},
        {"pin", {{"pin", "evil"}, {"pin", "evil", "13"}, {"pin", "evil", "13", "high"}}},
        {"ping",
         {{"ping", "evil", "-n", "4", "-i", "0"},
          {"ping", "*", "-n", "4", "-i", "0"},
          {"ping", "evil", "-n", "2", "-o", "json"}}},
        {"wait", {{"wait", "evil"}, {"wait", "evil", "--for", "lost"}}},
        {"release", {{"release", "evil"}, {"release", "evil", "--back"}}},
        {"flash", {{"flash", "evil"}, {"flash", "evil", image}}},
        {"events",
         {{"events", "-W", "300ms"},
          {"events", "-W", "300ms", "-o", "jsonl"},
          {"events", "evil", "--last", "20"},
          {"events", "--last", "20"},
          {"events", "--logs"},
          {"events", "--logs", "-o", "json"}}},
        {"values", {{"values", "evil"}, {"values", "evil/k", "-o", "csv"}, {"values", "evil/" + kEvil}}},
        {"model",
         {{"model"},
          {"model", "check", model},
          {"model", "docs", model},
          {"model", "evilkind"},
          {"model", "evilkind", "-o", "json"}}},
        {"link",
         {{"link", "list"},
          {"link", "list", "-o", "json"},
          {"link", "remove", kEvil},
          {"link", "evil/io/2", "evil/io/" + kEvil}}},
        {"open", {{"open", "--gateway", address, "--print"}, {"open", "x404", "--gateway", address}}},
        {"doctor", {{"doctor"}, {"doctor", "-o", "json"}}},
        {"forget",
         {{"forget", "evil", "--dry-run"},
          {"forget", "torn", "--dry-run"},
          {"forget", "--leftovers", "--dry-run"},
          {"forget", "--leftovers", "--dry-run", "-o", "name"}}},
        {"context", {{"context"}, {"context", "add", kEvil, address}}},
        {"secure", {{"secure", "show", "--dir", folder_.path().string()}}},
        {"backup",
         {{"backup", folder_.path().string() + "/evil.backup", "--etc", folder_.path().string(),
           "--no-secrets"}}},
        {"restore", {{"restore", model, "--etc", folder_.path().string()}}},
        {"completion", {{"completion", "bash"}}},
        {"help", {{"help", kEvil}}},
    };
    const std::set<std::string> show_it{"list",  "show",  "get",    "subscribe", "send",
                                        "label", "pin",   "ping",   "release",   "events",
                                        "open",  "model", "doctor", "flash",     "link"};
    std::size_t number = 0;
    for (const auto& verb : cli::all_verbs()) {
        if (number++ % kParts != GetParam()) continue;
        const auto found = tried.find(verb.name);
        ASSERT_NE(found, tried.end()) << verb.name << " is to be tried here";
        expect_harmless_words(found->second);
        const bool tested = show_it.count(verb.name) == 0 || showed_it_.count(verb.name) != 0;
        EXPECT_TRUE(tested) << verb.name << " was not put to the test";
    }
    expect_harmless_words({{"__complete", "bash", "asipctl show "}});
}

INSTANTIATE_TEST_SUITE_P(Part, HostileBoardTest, ::testing::Range(std::size_t{0}, kParts));

}  // namespace
}  // namespace asip::test
