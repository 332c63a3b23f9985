// SPDX-License-Identifier: Apache-2.0
// What a registry tells a webhook of lost boards: a real receiver, also one that is away, slow, or speaks
// TLS.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "running_registry.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/support/wait.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class NotifyTest : public ::testing::Test {
  protected:
    using Words = std::vector<std::string>;

    std::unique_ptr<ChildProcess> receiver(Words more = {}) {
        more.insert(more.begin(), HTTP_RECEIVER);
        auto process = std::make_unique<ChildProcess>(more);
        const auto line = process->wait_for_output("port [0-9]+");
        EXPECT_TRUE(line) << process->errors();
        if (line) port_ = line->substr(line->find("port ") + 5);
        return process;
    }

    void start_registry(const std::string& url, const std::map<std::string, std::string>& environment = {}) {
        registry_ = std::make_unique<ChildProcess>(
            Words{ASIP_REGISTRY_PROGRAM, "--broker", broker_.address(), "--id", "r1", "--notify", url},
            environment);
        ASSERT_TRUE(registry_->wait_for_errors("catalogue is complete")) << registry_->errors();
    }

    void announce(int first, int end, const std::string& host = "vm") {
        for (int i = first; i < end; ++i) {
            const auto board = "b" + std::to_string(i);
            auto text = json::parse(description_text(board, "s1", 1));
            text["agent"] = {{"host", host}, {"client", "agent-" + host}};
            probe_.publish("asip/servicebus/" + board + "/$description", text.dump(), true);
            probe_.publish("asip/servicebus/" + board + "/$state", "online", true);
        }
        ASSERT_TRUE(wait_until([&] { return state_of(probe_, "b" + std::to_string(end - 1)) == "online"; }));
    }

    void say(int first, int end, const std::string& state) {
        for (int i = first; i < end; ++i)
            probe_.publish("asip/servicebus/b" + std::to_string(i) + "/$state", state, true);
    }

    static std::vector<json> bodies(const ChildProcess& hook) {
        std::vector<json> all;
        const auto output = hook.output();
        std::istringstream lines(output.substr(0, output.rfind('\n') + 1));  // whole ones
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with("POST")) all.push_back(json::parse(line.substr(line.find('{'))));
        return all;
    }
    static std::size_t count(const ChildProcess& hook, const char* what) {
        std::size_t sum = 0;
        for (const auto& body : bodies(hook))
            sum += body[what]["count"].get<std::size_t>();
        return sum;
    }

    MosquittoBroker broker_;
    BusProbe probe_{broker_.port(), {"asip/registry/#"}};
    std::string port_;
    std::unique_ptr<ChildProcess> registry_;
};

TEST_F(NotifyTest, MassLoss_IsOneMessageWithinASecondAndABit) {
    const auto hook = receiver();
    start_registry("http://ann:p%40ss@127.0.0.1:" + port_ + "/lab/?key=1");
    announce(0, 300);
    say(0, 300, "lost");
    ASSERT_TRUE(hook->wait_for_output("POST .*\\}$")) << registry_->errors();
    EXPECT_THAT(hook->output(), HasSubstr("POST /lab/?key=1 {"));
    EXPECT_THAT(hook->output(), HasSubstr("USER Basic YW5uOnBAc3M=")) << "ann:p@ss";
    const auto first = bodies(*hook).front();
    EXPECT_THAT(first["text"].get<std::string>(), ::testing::EndsWith(" boards lost, all behind host vm"));
    EXPECT_EQ(first["registry"], "r1");
    EXPECT_EQ(first["lost"]["boards"][0]["reason"], "agent-gone");
    // A machine that is busy may spread them over more than half a second: then there are two.
    ASSERT_TRUE(wait_until([&] { return count(*hook, "lost") == 300; })) << hook->output();
    EXPECT_LE(bodies(*hook).size(), 2u);
    // They are back: told when its time has come.
    say(0, 300, "online");
    announce(0, 300);
    EXPECT_TRUE(wait_until([&] { return count(*hook, "back") == 300; })) << hook->output();
    EXPECT_LE(bodies(*hook).size(), 4u);
}

TEST_F(NotifyTest, ReceiverThatIsAwayOrRefusesOrHangs_IsTriedAgainAndHoldsNothingUp) {
    auto hook = receiver({"--answers", "0"});
    start_registry("http://127.0.0.1:" + port_ + "/");
    announce(0, 2);
    say(0, 1, "lost");
    ASSERT_TRUE(hook->wait_for_output("POST .*\\}$")) << registry_->errors();
    // The receiver hangs; the registry does not.
    const auto asked = std::chrono::steady_clock::now();
    EXPECT_EQ(state_of(probe_, "b0"), "lost");
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(5));
    say(1, 2, "lost");
    hook.reset();
    ASSERT_TRUE(registry_->wait_for_errors("no notice of lost boards can be delivered now"))
        << registry_->errors();
    EXPECT_THAT(registry_->errors(), HasSubstr("address=http://127.0.0.1:" + port_));
    hook = receiver({"--port", port_, "--answers", "503,204"});
    ASSERT_TRUE(wait_until([&] { return bodies(*hook).size() == 2; })) << registry_->errors();
    for (const auto& body : bodies(*hook))
        EXPECT_EQ(body["text"], "2 boards lost, all behind host vm (b0, b1)");
    ASSERT_TRUE(registry_->wait_for_errors("delivered again"));
}

TEST_F(NotifyTest, Https_IsVerified) {
    TempDir folder;
    const auto made = run({"openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
                           "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout",
                           folder.file("key.pem"), "-out", folder.file("cert.pem")});
    ASSERT_EQ(made.status, 0) << made.errors;
    const auto both = run(
        {"sh", "-c",
         "cat " + folder.file("key.pem") + " " + folder.file("cert.pem") + " >" + folder.file("both.pem")});
    ASSERT_EQ(both.status, 0);
    const auto hook = receiver({"--certificate", folder.file("both.pem")});
    start_registry("https://localhost:" + port_ + "/");
    announce(0, 1);
    say(0, 1, "lost");
    ASSERT_TRUE(registry_->wait_for_errors("no TLS")) << "a certificate that nobody trusts";
    registry_.reset();
    say(0, 1, "online");
    start_registry("https://localhost:" + port_ + "/", {{"SSL_CERT_FILE", folder.file("cert.pem")}});
    announce(0, 1);
    say(0, 1, "lost");
    ASSERT_TRUE(hook->wait_for_output("POST .*\\}$")) << registry_->errors();
    EXPECT_EQ(bodies(*hook).front()["text"],
              "b0 is lost: its agent died or lost the broker (behind host vm)");
}

TEST(Notify, AddressThatIsNone_IsToldAtOnce) {
    const auto ended = run({ASIP_REGISTRY_PROGRAM, "--notify", "pi.local/hook", "--id", "r1"});
    EXPECT_EQ(ended.status, 2);
    EXPECT_THAT(ended.errors,
                HasSubstr("asip-registry: --notify: \"pi.local/hook\" is not an address such as http://"));
    for (const char* bad :
         {"http://pi:99999/hook", "http://pi:0/hook", "http://ann@pi/hook", "http://a:%zz@pi/"})
        EXPECT_EQ(run({ASIP_REGISTRY_PROGRAM, "--notify", bad, "--id", "r1"}).status, 2) << bad;
}

}  // namespace
}  // namespace asip::test
