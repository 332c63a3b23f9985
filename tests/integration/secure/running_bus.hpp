// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {

/// A secured bus with each program on it: the agent of a simulated board, a registry, a gateway; and users of
/// each role that attack them.
class RunningBus : public SecuredBus {
  protected:
    RunningBus() {
        add({"board", "uno", "uno2"});
        add({"operator", "ann"});
        add({"viewer", "bob"});
        add({"registry"});
        add({"gateway"});
        start_broker();
        agent_ =
            std::make_unique<ChildProcess>(Words{ASIP_TEST_AGENT, "--serial", boards_.serial()} + as("uno"));
        registry_ =
            std::make_unique<ChildProcess>(Words{ASIP_TEST_REGISTRY, "--id", "hall"} + as("registry"));
        gateway_ =
            std::make_unique<ChildProcess>(Words{ASIP_TEST_GATEWAY, "--http", "127.0.0.1:0"} + as("gateway"));
        if (!becomes_online())
            throw std::runtime_error(agent_->errors() + registry_->errors() + gateway_->errors());
    }

    Finished asipctl(const std::string& user, const Words& words) const {
        return run(Words{ASIP_TEST_ASIPCTL} + words + as(user));
    }
    bool becomes_online() const {
        return wait_until(
            [&] { return asipctl("bob", {"list", "--state", "online", "-o", "name"}).output == "uno\n"; });
    }
    /// Whether the board executes a command that comes with QoS 1.
    bool agent_answers() const { return asipctl("ann", {"send", "uno", "--raw", "#,?"}).status == 0; }
    bool registry_answers() const {
        return asipctl("bob", {"list", "--state", "online", "-o", "name"}).output == "uno\n";
    }
    /// Whether an answer reaches the gateway.
    bool gateway_commands() const {
        const auto listening = gateway_->wait_for_errors("listening  address=http://127");
        if (!listening) return false;
        const auto begin = listening->find("http://");
        const auto url = listening->substr(begin, listening->find_first_of(" \n", begin) - begin);
        return run({"curl", "-s", "-o", "/dev/null", "-w", "%{http_code}", "-X", "POST", "-H",
                    "Content-Type: application/json", "-d", R"({"lines":["#,?"]})",
                    url + "/api/boards/uno/raw"})
                   .output == "200";
    }

    SimulatedBoards boards_{{"asip_uno"}};
    std::unique_ptr<ChildProcess> agent_, registry_, gateway_;
};

}  // namespace asip::test
