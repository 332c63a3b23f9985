// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/secure/secured_bus.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "asip/program/credentials.hpp"

namespace asip::test {

SecuredBus::SecuredBus() {
    const auto made = secure({"init", "--host", "localhost,127.0.0.1", "--port", std::to_string(port_)});
    if (made.status != 0) throw std::runtime_error(made.errors);
}

void SecuredBus::add(const Words& role_and_names) const {
    const auto added = secure(Words{"add"} + role_and_names);
    if (added.status != 0) throw std::runtime_error(added.errors);
}

void SecuredBus::start_broker() {
    std::ifstream made(file("mosquitto.conf"));
    std::string text{std::istreambuf_iterator<char>(made), {}};
    // Started by root, it would become a user who may not look into a test's folder.
    if (::geteuid() == 0) text += "user root\n";
    broker_ =
        std::make_unique<ChildProcess>(Words{"/usr/sbin/mosquitto", "-c", place_.write("run.conf", text)});
    if (!broker_->wait_for_errors(" running$")) throw std::runtime_error(broker_->errors());
}

BusProbe::Options SecuredBus::probe_options(const std::string& user) const {
    const auto read = program::read_credentials(credentials(user));
    if (!read) throw std::runtime_error(read.error());
    BusProbe::Options options;
    options.user = read->user;
    options.password = read->password;
    options.ca = credentials(user);
    return options;
}

void SecuredBus::announce(const std::string& board, const std::string& labels) const {
    auto agent = probe(board, {});
    agent.publish("asip/servicebus/" + board + "/$description",
                  R"({"board":")" + board +
                      R"(","session":"5f3a9c01","seq":1,"lease":600,"services":[],"labels":)" + labels + "}",
                  true);
    agent.publish("asip/servicebus/" + board + "/$state", "online", true);
    if (!wait_until([&] { return agent.all_acknowledged(); })) throw std::runtime_error(broker_log());
}

bool SecuredBus::may_publish(const std::string& user, const std::string& topic) const {
    // A program and a connection of its own: libmosquitto may lose the connection over a refusal.
    const auto options = probe_options(user);
    const auto published =
        run({"mosquitto_pub", "-V", "5", "-q", "1", "-h", "localhost", "-p", std::to_string(port_),
             "--cafile", options.ca, "-u", options.user, "-P", options.password, "-t", topic, "-m", ""});
    return published.status == 0 && published.errors.find("Not authorized") == std::string::npos;
}

bool SecuredBus::may_read(const std::string& user, const std::string& topic) const {
    const auto mark = "asip/reply/" + user + "/$self/mark";
    const auto reader = probe(user, {"#", topic, mark});
    auto admin = probe("admin", {});
    admin.publish(topic, "secret");
    admin.publish(mark, "end");
    if (!reader.wait_for(mark, "end")) throw std::runtime_error("no mark for " + user + ": " + broker_log());
    return reader.count(topic) > 0;
}

bool SecuredBus::may_connect(const Words& options) const {
    return run(Words{"mosquitto_pub", "-V", "5", "-h", "localhost", "-p", std::to_string(port_), "-t",
                     "asip/servicebus/$probe", "-m", ""} +
               options)
               .status == 0;
}

}  // namespace asip::test
