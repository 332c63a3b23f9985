// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/post.hpp>
#include <cstdlib>
#include <filesystem>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/integration/mqtt/slow_lookups.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/counted.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;

mqtt::Options tls_options(const MosquittoBroker& broker) {
    auto options = options_for(broker);
    options.ca_file = broker.certificates().ca;
    return options;
}

mqtt::ConnectionFailure first_failure(mqtt::Options options) {
    Recorder bus(std::move(options));
    bus.client->start();
    if (!bus.until([&] { return !bus.failures.empty() || bus.client->connected(); }))
        return {Kind::kUnreachable, {}, 0, "neither connected nor failed in time"};
    return bus.failures.empty() ? mqtt::ConnectionFailure{Kind::kClosed, {}, 0, "connected"}
                                : bus.failures[0];
}

/// A variable of the environment for a test; OpenSSL reads it when a connection is opened.
class EnvironmentVariable {
  public:
    EnvironmentVariable(const char* name, const std::string& value) : name_(name) {
        setenv(name, value.c_str(), 1);
    }
    ~EnvironmentVariable() { unsetenv(name_); }

  private:
    const char* name_;
};

TEST(MqttTls, Flood_LeavesOtherWorkOfTheLoopItsTurns) {
    MosquittoBroker broker({.tls = true,
                            .log_type = "error",
                            .extra_lines = {"max_queued_messages 0", "max_inflight_messages 0"}});
    constexpr std::size_t kMessages = 1500;
    Recorder bus(tls_options(broker));
    std::size_t in_a_turn = 0, most = 0;
    bus.at_message = [&](const mqtt::Message&) {
        ++in_a_turn;
        for (const auto until = Clock::now() + 300us; Clock::now() < until;) {
        }  // a program that works
    };
    bus.client->subscribe("flood", {.qos = 1});
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.subscribed_calls > 0; }));
    BusProbe::Options plain;
    plain.ca = broker.certificates().ca;
    BusProbe flood(broker.port(), {}, plain);
    for (std::size_t i = 0; i < kMessages; ++i)
        flood.publish("flood", std::string(8000, 'x'));
    const std::function<void()> other_work = [&] {
        most = std::max(most, std::exchange(in_a_turn, 0));
        if (bus.messages.size() < kMessages) boost::asio::post(bus.io, other_work);
    };
    boost::asio::post(bus.io, other_work);
    EXPECT_TRUE(bus.until([&] { return bus.messages.size() >= kMessages; }));
    EXPECT_LE(most, 64U);
}

// Each is a record of TLS.
TEST(MqttTls, ManySmallMessages_AreReadManyAtATime) {
    MosquittoBroker broker({.tls = true, .extra_lines = {"max_queued_messages 0"}});
    constexpr std::size_t kMessages = 2000;
    Recorder bus(tls_options(broker));
    bus.client->subscribe("small");
    ASSERT_TRUE(bus.connect());
    ASSERT_TRUE(bus.until([&] { return bus.subscribed_calls > 0; }));
    BusProbe::Options options;
    options.ca = broker.certificates().ca;
    BusProbe others(broker.port(), {}, options);
    for (std::size_t i = 0; i < kMessages; ++i)
        others.publish("small", "x");
    ASSERT_TRUE(wait_until([&] { return others.all_acknowledged(); }));
    const auto before = counted("thread-self", "syscr");
    ASSERT_TRUE(bus.until([&] { return bus.messages.size() == kMessages; }));
    EXPECT_LT(counted("thread-self", "syscr") - before, kMessages / 2);
}

TEST(MqttTls, SystemCertificateFolder_IsTrustedAlsoWithAClientCertificate) {
    MosquittoBroker broker({.tls = true, .require_client_certificate = true});
    TempDir folder;
    std::filesystem::copy(broker.certificates().ca, folder.file("ca.pem"));
    ASSERT_EQ(run({"openssl", "rehash", folder.path().string()}, {}, 10s).status, 0);
    const EnvironmentVariable none("SSL_CERT_FILE", folder.file("none"));
    const EnvironmentVariable certificates("SSL_CERT_DIR", folder.path().string());
    auto options = options_for(broker);
    options.cert_file = broker.certificates().client_cert;
    options.key_file = broker.certificates().client_key;
    Recorder bus(options);
    EXPECT_TRUE(bus.connect()) << (bus.failures.empty() ? "" : bus.failures[0].text);
}

TEST(MqttTls, UnknownToTheSystem_IsATlsFailureWithThatReason) {
    MosquittoBroker broker({.tls = true});
    const auto failure = first_failure(options_for(broker));
    EXPECT_EQ(failure.kind, Kind::kTls) << failure.text;
    EXPECT_TRUE(failure.fatal());
    EXPECT_TRUE(failure.hopeless);
    EXPECT_THAT(failure.text, testing::HasSubstr("self-signed certificate"));
}

TEST(MqttTls, CertificateForAnotherName_IsRefusedByNameAndByAddress) {
    MosquittoBroker broker({.tls = true, .certificate = {.names = "DNS:broker.example"}});
    for (const char* host : {"127.0.0.1", "localhost"}) {
        auto options = tls_options(broker);
        options.brokers[0].host = host;
        const auto failure = first_failure(options);
        EXPECT_EQ(failure.kind, Kind::kTls) << failure.text;
        EXPECT_THAT(failure.text, testing::HasSubstr("the certificate is not for " + std::string(host)));
    }
}

TEST(MqttTls, CertificateExpired_IsFatalWithThatReason) {
    MosquittoBroker broker(
        {.tls = true, .certificate = {.from = "20200101000000Z", .until = "20210101000000Z"}});
    const auto failure = first_failure(tls_options(broker));
    EXPECT_TRUE(failure.fatal()) << failure.text;
    EXPECT_THAT(failure.text, testing::HasSubstr("certificate has expired"));
}

TEST(MqttTls, CertificateNotYetValid_MayPassAndAsksForTheClock) {
    MosquittoBroker broker(
        {.tls = true, .certificate = {.from = "20450101000000Z", .until = "20460101000000Z"}});
    const auto failure = first_failure(tls_options(broker));
    EXPECT_EQ(failure.kind, Kind::kTls) << failure.text;
    EXPECT_FALSE(failure.fatal());
    EXPECT_FALSE(failure.hopeless);
    EXPECT_THAT(failure.text, testing::HasSubstr("not yet valid; is the clock right?"));
}

TEST(MqttTls, CaFileIsNoCertificate_FailsNamingTheFile) {
    MosquittoBroker broker({.tls = true});
    TempDir folder;
    auto options = tls_options(broker);
    options.ca_file = folder.write("ca.pem", "not a certificate");
    const auto failure = first_failure(options);
    EXPECT_EQ(failure.kind, Kind::kTls);
    EXPECT_THAT(failure.text, testing::HasSubstr(options.ca_file));
}

TEST(MqttTls, SlowNameServer_DoesNotStopTheLoopAndTheNameIsVerified) {
    MosquittoBroker broker({.tls = true});
    const SlowLookups slow(1500ms);
    auto options = tls_options(broker);
    options.brokers[0].host = "localhost";
    Recorder bus(options);
    Clock::duration longest{};
    auto last = Clock::now();
    bus.client->start();
    ASSERT_TRUE(bus.until([&] {
        longest = std::max(longest, Clock::now() - last);
        last = Clock::now();
        return bus.client->connected();
    }));
    EXPECT_LT(longest, 3000ms);
    EXPECT_TRUE(bus.failures.empty());
}

TEST(MqttTls, NameServerThatDoesNotAnswer_IsUnreachableWithinTheTimeOfAnAttempt) {
    const SlowLookups slow(1500ms);
    mqtt::Options options;
    options.brokers = {{"localhost", 1, true}, {"127.0.0.1", free_port(), false}};
    options.connect_timeout = 300ms;
    Recorder bus(options);
    bus.client->start();
    ASSERT_TRUE(bus.until([&] { return bus.failures.size() >= 2; }, 1200ms));
    EXPECT_EQ(bus.failures[0].kind, Kind::kUnreachable);
    EXPECT_THAT(bus.failures[0].text, testing::HasSubstr("name server"));
}

TEST(MqttTls, BrokerSignedByOurCa_ConnectsByAddressAndByName) {
    MosquittoBroker broker({.tls = true});
    for (const char* host : {"127.0.0.1", "localhost"}) {
        auto options = tls_options(broker);
        options.brokers[0].host = host;
        Recorder bus(options);
        EXPECT_TRUE(bus.connect()) << host;
        EXPECT_TRUE(bus.failures.empty());
    }
}

TEST(MqttTls, ClientCertificateDemandedAndMissing_IsATlsFailureAfterAFewAttemptsAtMost) {
    MosquittoBroker broker({.tls = true, .require_client_certificate = true});
    Recorder bus(tls_options(broker));
    bus.client->start();
    ASSERT_TRUE(bus.until([&] { return !bus.failures.empty() && bus.failures.back().kind == Kind::kTls; }));
    EXPECT_LE(bus.failures.size(), 3u);
    EXPECT_THAT(bus.failures.back().text, testing::HasSubstr("certificate"));
    EXPECT_TRUE(bus.failures.back().fatal());
}

TEST(MqttTls, BrokerSignedByAnotherCaButInsecure_Connects) {
    MosquittoBroker broker({.tls = true});
    auto options = tls_options(broker);
    options.ca_file = broker.certificates().other_ca;
    options.insecure = true;
    Recorder bus(options);
    EXPECT_TRUE(bus.connect());
}

TEST(MqttTls, PlainClientAtATlsPort_FailsWithoutHanging) {
    MosquittoBroker broker({.tls = true});
    auto options = options_for(broker);
    options.brokers[0].tls = false;
    Recorder bus(options);
    bus.client->start();
    ASSERT_TRUE(bus.until([&] { return !bus.failures.empty(); }));
    EXPECT_EQ(bus.failures[0].kind, Kind::kNoAnswer) << bus.failures[0].text;
}

}  // namespace
}  // namespace asip::test
