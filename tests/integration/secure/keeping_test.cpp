// SPDX-License-Identifier: Apache-2.0
// Adding, revoking and renewing while the broker runs.
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

using namespace std::chrono_literals;

class KeptBus : public SecuredBus {
  protected:
    KeptBus() {
        add({"board", "uno1", "uno2"});
        start_broker();
    }
    std::string all_files() const {
        return run({"sh", "-c",
                    "cd '" + folder() + "' && find . -type f ! -name '*.pid' | sort | xargs sha256sum"})
            .output;
    }
};

TEST_F(KeptBus, Revoked_IsOutWithinASecondAndOthersStay) {
    const auto out = probe("uno1", {"asip/uno1/in"});
    const auto stays = probe("uno2", {"asip/uno2/in"});
    ASSERT_TRUE(out.connected());
    const auto begin = std::chrono::steady_clock::now();
    const auto revoked = secure(Words{"revoke", "uno1"} + reload());
    ASSERT_EQ(revoked.status, 0) << revoked.errors;
    ASSERT_TRUE(wait_until([&] { return !out.connected(); }));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, time_limit(1s));
    auto admin = probe("admin", {});
    admin.publish("asip/uno2/in", "still here");
    EXPECT_TRUE(stays.wait_for("asip/uno2/in", "still here"));
    EXPECT_TRUE(stays.connected());
    EXPECT_EQ(broker_log().find("uno2 disconnected"), std::string::npos) << broker_log();
    EXPECT_FALSE(std::filesystem::exists(credentials("uno1")));
}

TEST_F(KeptBus, Revoked_CannotComeBackWithItsOldFile) {
    const auto old = probe_options("uno1");
    const auto copy = place_.write("copy", run({"cat", credentials("uno1")}).output);
    ASSERT_TRUE(may_connect({"--cafile", copy, "-u", "uno1", "-P", old.password}));
    ASSERT_EQ(secure(Words{"revoke", "uno1"} + reload()).status, 0);
    EXPECT_TRUE(
        wait_until([&] { return !may_connect({"--cafile", copy, "-u", "uno1", "-P", old.password}); }));
    ASSERT_EQ(secure(Words{"add", "board", "uno1"} + reload()).status, 0);
    const auto fresh = probe_options("uno1");
    EXPECT_TRUE(
        wait_until([&] { return may_connect({"--cafile", copy, "-u", "uno1", "-P", fresh.password}); }));
    EXPECT_FALSE(may_connect({"--cafile", copy, "-u", "uno1", "-P", old.password}));
}

TEST_F(KeptBus, Revoked_LeavesNothingInTheBroker) {
    ASSERT_EQ(secure(Words{"add", "viewer", "bob"} + reload()).status, 0);
    ASSERT_TRUE(wait_until([&] { return may_publish("bob", "asip/registry/query"); }));
    {
        auto board = probe("uno1", {}), viewer = probe("bob", {}), other = probe("uno2", {});
        for (const char* topic : {"asip/servicebus/uno1/$state", "asip/servicebus/uno1/$description",
                                  "asip/uno1/io/out", "asip/reply/ann/uno1/c1", "asip/reply/uno1/$self/c1"})
            board.publish(topic, "left", true);
        for (const char* topic : {"asip/servicebus/uno2/$demand/bob/c1",
                                  "asip/servicebus/nobody/$demand/bob/c2", "asip/reply/bob/$self/c1"})
            viewer.publish(topic, "left", true);
        other.publish("asip/servicebus/uno2/$state", "stays", true);
        ASSERT_TRUE(wait_until([&] {
            return board.all_acknowledged() && viewer.all_acknowledged() && other.all_acknowledged();
        }));
    }
    const auto retained = [&] {
        auto admin = probe("admin", {"asip/#"});
        admin.publish("asip/mark", "end");
        EXPECT_TRUE(admin.wait_for("asip/mark", "end"));
        std::vector<std::string> topics;
        for (const auto& message : admin.messages())
            if (message.retain) topics.push_back(message.topic);
        return topics;
    };
    ASSERT_EQ(retained().size(), 9U);
    const auto revoked = secure(Words{"revoke", "uno1", "bob"} + reload());
    ASSERT_EQ(revoked.status, 0) << revoked.errors;
    EXPECT_NE(revoked.output.find("5 messages that uno1 left"), std::string::npos) << revoked.output;
    EXPECT_NE(revoked.output.find("3 messages that bob left"), std::string::npos) << revoked.output;
    EXPECT_EQ(retained(), Words{"asip/servicebus/uno2/$state"});
    {
        auto admin = probe("admin", {});
        admin.publish("asip/servicebus/uno2/$demand/bob/c1", "left by a run that was interrupted", true);
        ASSERT_TRUE(wait_until([&] { return admin.all_acknowledged(); }));
    }
    EXPECT_EQ(secure(Words{"revoke", "bob"} + reload()).status, 1) << "there is no bob any more";
    EXPECT_EQ(retained(), Words{"asip/servicebus/uno2/$state"});
}

TEST_F(KeptBus, LinkedAgent_HearsItsSourceAloneUntilItIsUnlinkedOrTheSourceRevoked) {
    ASSERT_EQ(secure(Words{"add", "board", "uno3"} + reload()).status, 0);
    const Words heard{"asip/servicebus/uno2/$state", "asip/servicebus/uno2/$properties", "asip/uno2/$values",
                      "asip/uno2/io/out"};
    const auto hears = [&](const std::string& topic) { return may_read("uno1", topic); };
    const auto link = [&](const char* verb) { return secure(Words{verb, "uno1", "uno2"} + reload()).status; };
    EXPECT_FALSE(hears(heard.front()));
    ASSERT_EQ(link("link"), 0);
    for (const auto& topic : heard)
        EXPECT_TRUE(wait_until([&] { return hears(topic); })) << topic;
    for (const char* topic : {"asip/uno2/in", "asip/uno2/$stop", "asip/uno2/$link/ann/c",
                              "asip/reply/uno2/$self/c", "asip/uno3/io/out", "asip/servicebus/uno3/$state"})
        EXPECT_FALSE(hears(topic)) << topic;
    EXPECT_FALSE(may_read("uno2", "asip/uno1/io/out")) << "a source hears nothing";
    EXPECT_TRUE(may_publish("uno1", "asip/servicebus/uno2/$demand/uno1/c"));
    for (const char* topic : {"asip/servicebus/uno2/$demand/ann/c", "asip/uno2/in", "asip/uno2/io/out",
                              "asip/servicebus/uno3/$demand/uno1/c"})
        EXPECT_FALSE(may_publish("uno1", topic)) << topic;
    ASSERT_EQ(link("unlink"), 0);
    EXPECT_TRUE(wait_until([&] { return !hears(heard.back()); }));
    ASSERT_EQ(link("link"), 0);
    ASSERT_EQ(secure(Words{"revoke", "uno2"} + reload()).status, 0);
    ASSERT_EQ(secure(Words{"add", "board", "uno2"} + reload()).status, 0);
    EXPECT_TRUE(wait_until([&] { return may_publish("uno2", "asip/uno2/io/out"); }));
    EXPECT_FALSE(hears(heard.back())) << "another board of that name";
}

/// docs/tls-and-access.md, "Boards by label".
TEST_F(KeptBus, OperatorByLabel_CommandsTheBoardsOfThatMomentUntilItIsRenewedOrTheBoardRevoked) {
    const Words add_eve{"add", "operator", "eve", "-l", "class=4b"};
    const auto none = secure(add_eve + reload());
    EXPECT_NE(none.status, 0);
    EXPECT_NE(none.errors.find("no board is like * with labels class=4b"), std::string::npos) << none.errors;
    EXPECT_FALSE(std::filesystem::exists(credentials("eve")));
    announce("uno1", R"({"class":"4b"})");
    announce("uno2", R"({"class":"4a"})");
    const auto added = secure(add_eve + reload());
    ASSERT_EQ(added.status, 0) << added.errors;
    EXPECT_NE(added.output.find("have the labels class=4b: uno1\n"), std::string::npos) << added.output;
    EXPECT_NE(added.output.find("add operator eve -l 'class=4b'"), std::string::npos) << added.output;
    const auto commands = [&](const char* topic) { return may_publish("eve", topic); };
    EXPECT_TRUE(wait_until([&] { return commands("asip/uno1/io/in"); }));
    EXPECT_TRUE(commands("asip/uno1/$stop"));
    for (const char* topic : {"asip/uno1/in", "asip/uno1/$link/eve/c", "asip/uno2/io/in", "asip/uno2/$stop",
                              "asip/registry/forget", "asip/export/dashboard/n1"})
        EXPECT_FALSE(commands(topic)) << topic;
    EXPECT_TRUE(may_read("eve", "asip/uno2/io/out"));
    const auto shown = secure({"show", "eve"});
    EXPECT_NE(shown.output.find("uno1: those with the labels class=4b"), std::string::npos) << shown.output;
    EXPECT_EQ(secure({"check", "eve"}).status, 0);

    announce("uno2", R"({"class":"4b"})");
    EXPECT_FALSE(commands("asip/uno2/io/in")) << "a label that is set later gives nobody a right";
    const auto kept = secure(Words{"add", "operator", "eve"} + reload());
    EXPECT_NE(kept.output.find("kept     operator eve of uno1"), std::string::npos) << kept.output;
    EXPECT_FALSE(commands("asip/uno2/io/in")) << "nor does the name alone";
    ASSERT_EQ(secure(add_eve + reload()).status, 0);
    EXPECT_TRUE(wait_until([&] { return commands("asip/uno2/io/in"); }));
    ASSERT_EQ(secure(Words{"revoke", "uno2"} + reload()).status, 0);
    ASSERT_EQ(secure(Words{"add", "board", "uno2"} + reload()).status, 0);
    EXPECT_TRUE(wait_until([&] { return may_publish("uno2", "asip/uno2/io/out"); }));
    EXPECT_FALSE(commands("asip/uno2/io/in")) << "another board of that name";
    EXPECT_TRUE(commands("asip/uno1/io/in"));
}

/// Its links, and what it asked the broker to keep, would go on at boards that it may not command any more.
TEST_F(KeptBus, OperatorOfEveryBoard_IsRevokedBeforeItGetsSomeBoardsAlone) {
    announce("uno1", R"({"class":"4b"})");
    ASSERT_EQ(secure(Words{"add", "operator", "zoe"} + reload()).status, 0);
    const auto before = all_files();
    const auto refused = secure(Words{"add", "operator", "zoe", "-l", "class=4b"} + reload());
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("asipctl secure revoke zoe"), std::string::npos) << refused.errors;
    EXPECT_EQ(all_files(), before);
    ASSERT_EQ(secure(Words{"revoke", "zoe"} + reload()).status, 0);
    EXPECT_EQ(secure(Words{"add", "operator", "zoe", "-l", "class=4b"} + reload()).status, 0);
}

TEST_F(KeptBus, LabelsForAnotherRole_AreRefused_AndNothingIsDone) {
    for (const char* role : {"viewer", "board", "gateway"}) {
        const auto refused = secure(Words{"add", role, "eve", "-l", "class=4b"} + reload());
        EXPECT_EQ(refused.status, 2) << role;
        EXPECT_NE(refused.errors.find("has no --selector"), std::string::npos) << refused.errors;
    }
    EXPECT_EQ(secure({"show", "eve"}).status, 1);
}

/// No topic says whose a command is. It would be executed again by whatever subscribes to it.
TEST_F(KeptBus, RevokedOperator_ItsRetainedCommandsAreNamedAndPruneKnowsThem) {
    ASSERT_EQ(secure(Words{"add", "operator", "eve"} + reload()).status, 0);
    ASSERT_TRUE(wait_until([&] { return may_publish("eve", "asip/registry/query"); }));
    const Words left{"asip/registry/forget", "asip/registry/hall/forget", "asip/uno1/$stop", "asip/uno1/in",
                     "asip/uno1/io/in"};
    {
        auto eve = probe("eve", {});
        for (const auto& topic : left)
            eve.publish(topic, "left", true);
        ASSERT_TRUE(wait_until([&] { return eve.all_acknowledged(); }));
    }
    const auto revoked = secure(Words{"revoke", "eve"} + reload());
    ASSERT_EQ(revoked.status, 0) << revoked.errors;
    EXPECT_NE(revoked.output.find("the broker keeps 5 commands; eve may have left them"), std::string::npos)
        << revoked.output;
    const auto prune = [&](const Words& more) {
        return run(Words{ASIP_TEST_ASIPCTL, "forget", "--leftovers", "-o", "name"} + more + as("admin"));
    };
    std::string names;
    for (const auto& topic : left)
        names += topic + "\n";
    EXPECT_EQ(prune({"--dry-run"}).output, names);
    EXPECT_EQ(prune({"--dry-run"}).output, names) << "nothing was cleared";
    EXPECT_EQ(prune({"--only", "commands"}).output, names);
    EXPECT_EQ(prune({}).output, "");
}

/// What is passed over in silence is done otherwise than it was meant.
TEST_F(KeptBus, OptionThatAnActionDoesNotKnow_IsRefusedAndNothingIsDone) {
    const auto before = all_files();
    for (const auto& words : std::vector<Words>{{"add", "operator", "zoe", "--dry-run"},
                                                {"add", "operator", "zoe", "--yes"},
                                                {"add", "operator", "zoe", "--host", "a"},
                                                {"add", "operator", "zoe", "--port", "1"},
                                                {"add", "operator", "zoe", "--mosquitto", "x"},
                                                {"revoke", "uno1", "--dry-run"},
                                                {"revoke", "uno1", "--here"},
                                                {"renew", "uno1", "--dry-run"},
                                                {"renew", "uno1", "--host", "a"},
                                                {"renew", "broker", "--dry-run"},
                                                {"show", "--dry-run"},
                                                {"check", "--reload-pid", "1"},
                                                {"undo", "--here"}}) {
        const auto refused = secure(words);
        EXPECT_EQ(refused.status, 2) << words.back();
        EXPECT_NE(refused.errors.find("secure " + words.front() + " has no --"), std::string::npos)
            << refused.errors;
        EXPECT_EQ(all_files(), before) << words.front();
    }
}

/// Mosquitto's own limits cannot tell which user fills it; it stays, and serves those whose messages still
/// fit.
TEST_F(KeptBus, BrokerThatAUserFills_StaysBelowItsLimitAndServesTheOthers) {
    const std::string limit = "memory_limit ";
    std::string text = run({"cat", file("mosquitto.conf")}).output;
    const auto at = text.find(limit);
    ASSERT_NE(at, std::string::npos);
    ASSERT_NE(text.find("\npersistent_client_expiration 1h\n"), std::string::npos);
    text.replace(at, text.find('\n', at) - at, limit + "33554432");
    if (::geteuid() == 0) text += "user root\n";
    broker_.reset();
    broker_ =
        std::make_unique<ChildProcess>(Words{"/usr/sbin/mosquitto", "-c", place_.write("run.conf", text)});
    ASSERT_TRUE(broker_->wait_for_errors(" running$"));
    const auto stays = probe("uno2", {"asip/uno2/in"});
    auto admin = probe("admin", {});
    auto attacker = probe("uno1", {});
    try {
        for (int i = 0; i < 400; ++i)
            attacker.publish("asip/uno1/s" + std::to_string(i) + "/out", std::string(250'000, 'x'), true);
    } catch (const std::runtime_error&) {
        // A broker that has no memory left closes the connection.
    }
    EXPECT_TRUE(broker_->wait_for_errors("out of memory")) << broker_log();
    admin.publish("asip/uno2/in", "still here");
    EXPECT_TRUE(stays.wait_for("asip/uno2/in", "still here"));
    EXPECT_EQ(stays.reconnects(), 0);
    EXPECT_LT(broker_->resident_bytes(), memory_limit(std::size_t{64} << 20));
}

TEST_F(KeptBus, RunningBroker_IsFoundByItsPidFile) {
    const auto added = secure({"add", "operator", "ann", "-o", "jsonl"});
    EXPECT_NE(added.output.find("\"reloaded\""), std::string::npos) << added.output;
    EXPECT_TRUE(wait_until([&] { return may_publish("ann", "asip/uno1/in"); }));
}

TEST_F(KeptBus, PidOfAnotherProgram_IsSentNoSignal) {
    ChildProcess other({"sleep", "60"});
    const auto added = secure({"add", "operator", "ann", "--reload-pid", std::to_string(other.pid())});
    EXPECT_EQ(added.status, 0);
    EXPECT_NE(added.output.find("let it read it"), std::string::npos) << added.output;
    EXPECT_TRUE(other.running());
}

TEST_F(KeptBus, RenewedUser_NeedsItsNewFile) {
    const auto old = probe_options("uno1");
    ASSERT_EQ(secure(Words{"renew", "uno1"} + reload()).status, 0);
    const auto fresh = probe_options("uno1");
    EXPECT_NE(old.password, fresh.password);
    EXPECT_TRUE(
        wait_until([&] { return may_connect({"--cafile", fresh.ca, "-u", "uno1", "-P", fresh.password}); }));
    EXPECT_FALSE(may_connect({"--cafile", fresh.ca, "-u", "uno1", "-P", old.password}));
}

TEST_F(KeptBus, RenewedCertificate_IsShownWithoutDroppingBoards) {
    const auto stays = probe("uno2", {"asip/uno2/in"});
    const auto serial = [&] {
        return run({"sh", "-c",
                    "openssl s_client -connect localhost:" + std::to_string(port()) +
                        " </dev/null 2>/dev/null | openssl x509 -noout -serial"})
            .output;
    };
    const auto before = serial();
    ASSERT_NE(before, "");
    ASSERT_EQ(secure(Words{"renew", "broker"} + reload()).status, 0);
    EXPECT_TRUE(wait_until([&] { return serial() != before; }));
    EXPECT_TRUE(stays.connected());
    EXPECT_EQ(broker_log().find("uno2 disconnected"), std::string::npos) << broker_log();
    EXPECT_TRUE(may_publish("uno1", "asip/uno1/out")) << "the authority is the same";
}

TEST_F(KeptBus, Repeated_ChangesNothing) {
    const auto before = all_files();
    ASSERT_NE(before, "");
    EXPECT_EQ(secure({"init"}).status, 0);
    EXPECT_EQ(secure({"add", "board", "uno1", "uno2"}).status, 0);
    EXPECT_EQ(secure({"show"}).status, 0);
    EXPECT_EQ(all_files(), before);
}

TEST_F(KeptBus, InterruptedAddition_IsCompletedWithTheSameFile) {
    const auto saved = run({"cat", file("bus.json")}).output;
    add({"operator", "ann"});
    const auto given = run({"cat", credentials("ann")}).output;
    ASSERT_EQ(run({"sh", "-c", "cat > '" + file("bus.json") + "' <<'END'\n" + saved + "END"}).status, 0);
    ASSERT_EQ(secure(Words{"add", "operator", "ann"} + reload()).status, 0);
    EXPECT_EQ(run({"cat", credentials("ann")}).output, given);
    EXPECT_TRUE(wait_until([&] { return may_publish("ann", "asip/uno1/in"); }));
}

TEST_F(KeptBus, ManyAtOnce_WaitForEachOther) {
    std::vector<std::unique_ptr<ChildProcess>> runs;
    for (int i = 0; i < 8; ++i) {
        const auto number = std::to_string(i);
        runs.push_back(std::make_unique<ChildProcess>(
            Words{ASIP_TEST_ASIPCTL, "secure", "add", "viewer", "v" + number, "--dir", folder()}));
        if (i % 2 == 1)
            runs.push_back(std::make_unique<ChildProcess>(
                Words{ASIP_TEST_ASIPCTL, "secure", "renew", "uno2", "--dir", folder()}));
    }
    for (const auto& one : runs)
        EXPECT_EQ(one->wait_exit(), 0) << one->errors();
    ASSERT_EQ(secure({"revoke", "uno1"}).status, 0);
    for (int i = 0; i < 8; ++i) {
        const auto name = "v" + std::to_string(i);
        EXPECT_TRUE(wait_until([&] { return may_publish(name, "asip/registry/query"); })) << name;
    }
    EXPECT_TRUE(may_publish("uno2", "asip/uno2/out")) << "the file is that of the last renewal";
}

TEST_F(KeptBus, NameInUse_IsRefusedAndKept) {
    const auto before = all_files();
    const auto refused = secure({"add", "operator", "uno1"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("in use, by the board"), std::string::npos) << refused.errors;
    EXPECT_EQ(secure({"add", "viewer", "a/b"}).status, 2);
    EXPECT_EQ(secure({"add", "king", "ann"}).status, 2);
    EXPECT_EQ(secure({"add", "operator"}).status, 2);
    const auto nobody = secure({"revoke", "uno1x"});
    EXPECT_EQ(nobody.status, 1);
    EXPECT_NE(nobody.errors.find("did you mean \"uno1\""), std::string::npos) << nobody.errors;
    EXPECT_EQ(secure({"revoke", "uno1", "nobody"}).status, 1) << "all or none";
    EXPECT_EQ(all_files(), before);
}

TEST_F(KeptBus, OtherHosts_AreNotTakenByInit) {
    const auto refused = secure({"init", "--host", "other.example"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("renew broker"), std::string::npos) << refused.errors;
    EXPECT_EQ(secure({"renew", "broker", "--host", "a b"}).status, 2);
}

TEST_F(KeptBus, Secrets_AreReadableByTheirOwnerAlone) {
    add({"operator", "ann"});
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
        const bool secret = entry.is_regular_file() && entry.path().extension() != ".crt" &&
                            entry.path().filename() != "mosquitto.conf" && entry.path().extension() != ".pid";
        struct stat status{};
        ASSERT_EQ(::stat(entry.path().c_str(), &status), 0);
        EXPECT_TRUE(!secret || (status.st_mode & 0777) == 0600) << entry.path();
    }
}

}  // namespace
}  // namespace asip::test
