// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "http_client.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/support/patterns.hpp"

namespace asip::test {

/// The program as users start it, at a free port of 127.0.0.1.
class RunningGateway {
  public:
    explicit RunningGateway(const std::string& broker, const std::vector<std::string>& more = {})
        : process_(arguments(broker, more)) {
        const auto line = process_.wait_for_errors("listening  address=https?://127\\.0\\.0\\.1:[0-9]+");
        const auto match = first_match(line.value_or(""), R"(127\.0\.0\.1:([0-9]+))");
        if (!match) throw std::runtime_error("asip-gateway: " + process_.errors());
        port_ = static_cast<std::uint16_t>(std::stoi(match->at(1)));
    }

    std::uint16_t port() const { return port_; }
    ChildProcess& process() { return process_; }
    bool ready() {
        return wait_until([this] { return get(port_, "/readyz").status == 200; });
    }
    /// Until the board is in this state, and described: its state may come before its description.
    bool becomes(const std::string& board, const std::string& state) {
        return wait_until([&] {
            const auto answer = get(port_, "/api/boards/" + board);
            return answer.status == 200 && answer.json().value("state", "") == state &&
                   answer.json().contains("description");
        });
    }

  private:
    static std::vector<std::string> arguments(const std::string& broker,
                                              const std::vector<std::string>& more) {
        std::vector<std::string> all{ASIP_PROGRAMS "/asip-gateway", "--broker", broker, "--http",
                                     "127.0.0.1:0"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    ChildProcess process_;
    std::uint16_t port_ = 0;
};

inline std::string described(const std::string& board, int seq = 1) {
    return R"({"board":")" + board + R"(","session":"a","seq":)" + std::to_string(seq) +
           R"(,"lease":600,"services":[{"name":"distance","id":"D","model":"distance@1","title":"Distance"},)" +
           R"({"name":"servo","id":"S","model":"servo@1","title":"Servos"}]})";
}

/// A broker, a gateway, and a probe that announces boards.
class GatewayTest : public testing::Test {
  protected:
    explicit GatewayTest(const std::vector<std::string>& more = {}) : gateway_(broker_.address(), more) {
        if (!gateway_.ready()) throw std::runtime_error("not ready: " + gateway_.process().errors());
    }
    void announce(const std::string& board) {
        probe_.publish("asip/servicebus/" + board + "/$description", described(board));
        probe_.publish("asip/servicebus/" + board + "/$state", "online");
        ASSERT_TRUE(gateway_.becomes(board, "online"));
    }
    std::uint16_t port() const { return gateway_.port(); }
    HttpAnswer ask(const std::string& target) const { return get(port(), target); }
    bool alive() const { return ask("/healthz").status == 200; }

    MosquittoBroker broker_;
    RunningGateway gateway_;
    BusProbe probe_{broker_.port()};
};

}  // namespace asip::test
