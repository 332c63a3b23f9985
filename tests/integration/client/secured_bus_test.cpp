// SPDX-License-Identifier: Apache-2.0
// The broker configuration that is shipped for several machines, with everything on it: TLS, passwords,
// access rules.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "asip/client/blocking_board.hpp"
#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

using client::BlockingBoard;
using ::testing::HasSubstr;

std::string shipped(const std::string& file) {
    std::ifstream in(ASIP_TEST_PACKAGING "/mosquitto/" + file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Mosquitto with asip-secured.conf as it is, but for the places of its files and its ports.
class SecuredBroker {
  public:
    enum class By { kPassword, kCertificate };

    explicit SecuredBroker(By by = By::kPassword)
        : certificates_(make_certificates(folder_)), port_(free_port()), local_port_(free_port()) {
        std::string text = shipped("asip-secured.conf");
        const auto put = [&text](const std::string& what, const std::string& real) {
            const auto place = text.find(what);
            if (place == std::string::npos) throw std::runtime_error("asip-secured.conf has no " + what);
            text.replace(place, what.size(), real);
        };
        put("/etc/mosquitto/asip.passwords", passwords());
        put("/etc/mosquitto/asip-secured.acl", folder_.write("acl", shipped("asip-secured.acl")));
        put("/etc/mosquitto/certs/asip-broker.crt", certificates_.server_cert);
        put("/etc/mosquitto/certs/asip-broker.key", certificates_.server_key);
        put("listener 1883 127.0.0.1", "listener " + std::to_string(local_port_) + " 127.0.0.1");
        put("listener 8883", "listener " + std::to_string(port_) + " 127.0.0.1");
        if (by == By::kCertificate) {
            put("tls_version tlsv1.2", "tls_version tlsv1.2\ncafile " + certificates_.ca +
                                           "\nrequire_certificate true\nuse_identity_as_username true");
        }
        text += "user root\npersistence_location " + folder_.path().string() + "/\n";
        const auto file = folder_.write("mosquitto.conf", text);
        process_.emplace(std::vector<std::string>{"/usr/sbin/mosquitto", "-c", file});
        if (!process_->wait_for_errors(" running$")) throw std::runtime_error(process_->errors());
    }

    std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
    std::uint16_t port() const { return port_; }
    std::uint16_t local_port() const { return local_port_; }
    const Certificates& certificates() const { return certificates_; }
    std::string password_file(const std::string& user) const { return folder_.file(user + ".password"); }

    /// What each program is started with.
    std::vector<std::string> options(const std::string& user) const {
        return {"--broker",        "mqtts://" + host(), "--user", user,
                "--password-file", password_file(user), "--ca",   certificates_.ca};
    }
    BusProbe::Options probe(const std::string& user) const {
        BusProbe::Options options;
        options.user = user;
        options.password = "of-" + user;
        options.ca = certificates_.ca;
        return options;
    }

  private:
    std::string passwords() const {
        const auto file = folder_.write("passwords", "");
        for (const std::string user : {"uno", "registry", "operator", "viewer", "admin"}) {
            folder_.write(user + ".password", "of-" + user + "\n");
            run({"mosquitto_passwd", "-b", file, user, "of-" + user});
        }
        return file;
    }

    TempDir folder_;
    Certificates certificates_;
    std::uint16_t port_, local_port_;
    std::optional<ChildProcess> process_;
};

std::vector<std::string> with(std::vector<std::string> command, const std::vector<std::string>& more) {
    command.insert(command.end(), more.begin(), more.end());
    return command;
}

class SecuredBus : public ::testing::Test {
  protected:
    SecuredBroker broker_;
    SimulatedBoards boards_{{"asip_uno"}};
    ChildProcess agent_{with(
        {ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "uno", "--label", "room=lab,io/name=pins"},
        broker_.options("uno"))};

    client::Result<BlockingBoard> open_as(const std::string& user) {
        client::Options options;
        options.user = user;
        options.password_file = broker_.password_file(user);
        options.ca = broker_.certificates().ca;
        options.command_timeout = std::chrono::seconds(2);
        return BlockingBoard::open("mqtts://" + broker_.host() + "/uno", options);
    }
};

TEST_F(SecuredBus, Operator_CommandsTheBoardThroughItsAgent) {
    auto board = open_as("operator");
    ASSERT_TRUE(board) << to_string(board.error()) << agent_.errors();
    ASSERT_TRUE(board->set_pin_mode(13, protocol::PinMode::kOutput));
    ASSERT_TRUE(board->digital_write(13, true));
    EXPECT_TRUE(boards_.wait_for_led("on"));
}

TEST_F(SecuredBus, OptionsOfTheDocumentation_OpenTheBoard) {
    const std::string documented_address = "mqtts://" + broker_.host() + "/uno";
    const std::string documented_password_file = broker_.password_file("operator");
    const std::string documented_ca = broker_.certificates().ca;
#include "documented/options.inc"
    ASSERT_TRUE(board) << to_string(board.error()) << agent_.errors();
    EXPECT_TRUE(board->set_pin_mode(13, protocol::PinMode::kOutput));
}

TEST_F(SecuredBus, PythonWithPlainMqtt_CommandsTheBoardAndTrustsNoOtherAuthority) {
    const auto lamp = [this](const std::string& ca, const std::string& password) {
        return std::make_unique<ChildProcess>(
            std::vector<std::string>{"/usr/bin/python3", "-u", ASIP_TEST_SOURCE "/examples/plain_mqtt.py",
                                     "uno", "127.0.0.1", std::to_string(broker_.port())},
            std::map<std::string, std::string>{
                {"ASIP_USER", "operator"}, {"ASIP_PASSWORD", password}, {"ASIP_CA", ca}});
    };
    const auto own = lamp(broker_.certificates().ca, "of-operator");
    ASSERT_TRUE(own->wait_for_output("uno is online")) << agent_.errors() << own->errors();
    // This board has no distance sensor and refuses one of three commands: that answer reached it.
    ASSERT_TRUE(own->wait_for_output("failed: .*distance")) << own->output() << own->errors();
    boards_.press();
    EXPECT_TRUE(boards_.wait_for_led("on")) << own->output() << own->errors();
    const auto other = lamp(broker_.certificates().other_ca, "of-operator");
    EXPECT_NE(other->wait_exit(), 0);
    EXPECT_THAT(other->errors(), HasSubstr("certificate verify failed"));
    const auto wrong = lamp(broker_.certificates().ca, "wrong");
    EXPECT_EQ(wrong->wait_exit(), 1);
    EXPECT_THAT(wrong->errors(), HasSubstr("the broker refused this client"));
}

TEST_F(SecuredBus, AuthorityThatDidNotSignTheBroker_IsNotTrusted) {
    client::Options options;
    options.user = "operator";
    options.password_file = broker_.password_file("operator");
    options.ca = broker_.certificates().other_ca;
    const auto board = BlockingBoard::open("mqtts://" + broker_.host() + "/uno", options);
    ASSERT_FALSE(board);
    EXPECT_EQ(board.error().kind, client::Error::Kind::kUnreachable);
    EXPECT_THAT(board.error().text, HasSubstr("certificate"));
}

TEST(SecuredBusByCertificate, CertificateNamesTheUser) {
    const SecuredBroker broker(SecuredBroker::By::kCertificate);
    const Certificates& made = broker.certificates();  // the client's names "test-client"
    SimulatedBoards boards({"asip_uno"});
    ChildProcess agent({ASIP_TEST_AGENT, "--serial", boards.serial(), "--name", "test-client", "--broker",
                        "mqtts://" + broker.host(), "--ca", made.ca, "--cert", made.client_cert, "--key",
                        made.client_key});
    BusProbe::Options by_password = broker.probe("operator");
    by_password.ca.clear();
    BusProbe here(broker.local_port(), {"asip/#"}, by_password);
    EXPECT_TRUE(here.wait_for("asip/servicebus/test-client/$state", "online")) << agent.errors();

    const Finished without = run(with({ASIP_TEST_ASIPCTL, "list"}, broker.options("operator")));
    EXPECT_EQ(without.status, 3) << "a password is not enough there: " << without.errors;
}

}  // namespace
}  // namespace asip::test
