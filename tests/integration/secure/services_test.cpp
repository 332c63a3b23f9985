// SPDX-License-Identifier: Apache-2.0
// The services of a machine find their credentials by themselves, in one folder.
#include <gmock/gmock.h>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;

class ServicesOnSecuredBus : public SecuredBus {
  protected:
    ServicesOnSecuredBus() {
        add({"board", "uno"});
        add({"operator", "ann"});
        add({"registry"});
        start_broker();
    }
    Words from_folder() const {
        return {"--config", settings_file("credentials-dir = " + file("credentials") + "\n")};
    }

    SimulatedBoards boards_{{"asip_uno"}};
};

TEST_F(ServicesOnSecuredBus, EachTakesItsOwnFile) {
    ChildProcess registry(Words{ASIP_TEST_REGISTRY, "--id", "hall"} + from_folder());
    ChildProcess agent(Words{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "uno"} + from_folder());
    EXPECT_TRUE(wait_until([&] {
        return run(Words{ASIP_TEST_ASIPCTL, "list", "--state", "online", "-o", "name"} + as("ann")).output ==
               "uno\n";
    })) << agent.errors()
        << registry.errors();
    EXPECT_EQ(run(Words{ASIP_TEST_ASIPCTL, "pin", "uno", "13", "high"} + as("ann")).status, 0);
}

TEST_F(ServicesOnSecuredBus, Labels_AreSetByOperatorsAndReadByViewers) {
    add({"viewer", "bob"});
    ChildProcess registry(Words{ASIP_TEST_REGISTRY, "--id", "hall", "--history", place_.file("history.db")} +
                          from_folder());
    ChildProcess agent(Words{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "uno", "--state-dir",
                             place_.file("state")} +
                       from_folder());
    const auto label = [this](const std::string& user, const Words& more) {
        return run(Words{ASIP_TEST_ASIPCTL, "label"} + more + as(user));
    };
    EXPECT_TRUE(wait_until([&] { return label("ann", {"uno", "room=lab"}).status == 0; })) << agent.errors();
    for (const char* version : {"5", "3.1.1"}) {
        const auto denied = label("bob", {"uno", "room=hall", "--timeout", "3s", "--mqtt-version", version});
        EXPECT_NE(denied.status, 0) << version;
        EXPECT_THAT(denied.errors, HasSubstr("asipctl secure add operator NAME")) << version;
    }
    const auto read = label("bob", {"uno", "--format", "{labels.room}"});
    EXPECT_EQ(read.output, "lab\n") << read.errors;
    EXPECT_TRUE(wait_until([&] {
        return run(Words{ASIP_TEST_ASIPCTL, "events", "uno", "--last", "20", "--format", "{what} {by}"} +
                   as("bob"))
                   .output.find("command ann\n") != std::string::npos;
    })) << registry.errors();
}

/// A broker does not say that it denies a message of MQTT 3.1.1.
TEST_F(ServicesOnSecuredBus, DeniedWithoutAWord_IsSaidToBePossible) {
    add({"viewer", "bob"});
    ChildProcess registry(Words{ASIP_TEST_REGISTRY, "--id", "hall"} + from_folder());
    ChildProcess agent(Words{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "uno"} + from_folder());
    EXPECT_TRUE(wait_until([&] {
        return run(Words{ASIP_TEST_ASIPCTL, "list", "--state", "online", "-o", "name"} + as("bob")).output ==
               "uno\n";
    }));
    for (const auto& verb :
         {Words{"send", "uno/io", "write", "13", "1"}, Words{"send", "uno", "--raw", "#,?"},
          Words{"pin", "uno", "13", "high"}, Words{"stop", "uno"}}) {
        const auto denied = run(Words{ASIP_TEST_ASIPCTL} + verb + as("bob") +
                                Words{"--timeout", "1s", "--mqtt-version", "3.1.1"});
        EXPECT_NE(denied.status, 0) << verb[0];
        EXPECT_THAT(denied.errors, HasSubstr("access rules do not let")) << verb[0];
        EXPECT_THAT(denied.errors, HasSubstr("asipctl secure add operator NAME")) << verb[0];
    }
}

TEST_F(ServicesOnSecuredBus, FileForAnotherBoard_EndsTheAgentWithItsName) {
    const auto text = run({"cat", credentials("uno")}).output;
    const auto wrong = place_.write("other.credentials", text);
    const auto ended = run({ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "other", "--config",
                            settings_file("credentials-dir = " + wrong.substr(0, wrong.rfind('/')) + "\n")});
    EXPECT_EQ(ended.status, 2);
    EXPECT_THAT(ended.errors, HasSubstr("other.credentials is not for board other"));
}

TEST_F(ServicesOnSecuredBus, ForAServiceOfThisMachine_NeedsTheFolderOfThePackages) {
    const auto refused = secure({"add", "board", "uno2", "--here"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.errors, HasSubstr("asip-common"));
    EXPECT_EQ(secure({"revoke", "uno2"}).status, 1) << "nobody was added";
}

}  // namespace
}  // namespace asip::test
