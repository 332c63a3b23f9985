// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "asip/client/board.hpp"

namespace asip::client {

/// A transport that answers from a script and records what it was asked. Each command takes the next step of
/// the script, which may report things to the listener before it answers.
class ScriptedTransport : public Transport {
  public:
    using Json = nlohmann::json;
    using Step = std::function<Result<Json>(Listener&)>;

    explicit ScriptedTransport(boost::asio::io_context& io) : io_(io) {}

    boost::asio::any_io_executor executor() const override { return io_.get_executor(); }
    Awaitable<void> open(Listener& its_listener) override {
        listener = &its_listener;
        co_return opening;
    }
    Awaitable<Json> command(std::string service, Json command) override {
        asked.push_back(service + " " + command.dump());
        co_return take_step();
    }
    Awaitable<void> raw(std::string line) override {
        asked.push_back(std::move(line));
        auto done = take_step();
        co_return done ? Result<void>() : Result<void>(Unexpected<Error>(done.error()));
    }
    std::string board_name() const override { return "uno1"; }
    std::vector<ServiceInfo> services() const override {
        return {{"io", 'I', "ASIP core IO"}, {"distance", 'D', "Distance"}};
    }
    void close() override { closed = true; }

    Result<void> opening;
    std::deque<Step> script;
    std::vector<std::string> asked;
    Listener* listener = nullptr;
    bool closed = false;

  private:
    Result<Json> take_step() {
        if (script.empty()) return Json();
        const Step step = std::move(script.front());
        script.pop_front();
        return step(*listener);
    }

    boost::asio::io_context& io_;
};

}  // namespace asip::client
