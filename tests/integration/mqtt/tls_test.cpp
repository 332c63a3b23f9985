#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/recorder.hpp"
#include "tests/support/bus_probe.hpp"

namespace asip::test {
namespace {

using Kind = mqtt::ConnectionFailure::Kind;

mqtt::Options tls_options(const MosquittoBroker& broker) {
    auto options = options_for(broker);
    options.ca_file = broker.certificates().ca;
    return options;
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

TEST(MqttTls, ClientCertificateDemandedAndShown_Connects) {
    MosquittoBroker broker({.tls = true, .require_client_certificate = true});
    auto options = tls_options(broker);
    options.cert_file = broker.certificates().client_cert;
    options.key_file = broker.certificates().client_key;
    Recorder bus(options);
    EXPECT_TRUE(bus.connect());
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

TEST(MqttTls, BrokerSignedByAnotherCa_IsATlsFailure) {
    MosquittoBroker broker({.tls = true});
    auto options = tls_options(broker);
    options.ca_file = broker.certificates().other_ca;
    Recorder bus(options);
    bus.client->start();
    ASSERT_TRUE(bus.until([&] { return !bus.failures.empty(); }));
    EXPECT_EQ(bus.failures[0].kind, Kind::kTls) << bus.failures[0].text;
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

TEST(MqttTls, ThousandsOfMessages_NoneStaysInTheDecryptedBuffer) {
    MosquittoBroker broker({.tls = true});
    BusProbe probe(broker.port(), {}, {.ca = broker.certificates().ca});
    Recorder bus(tls_options(broker));
    bus.client->subscribe("in", {.qos = 1});
    ASSERT_TRUE(bus.connect());
    for (int i = 0; i < 3000; ++i)
        probe.publish("in", std::to_string(i), false, i % 2);
    ASSERT_TRUE(bus.until([&] { return bus.messages.size() == 3000; }));
    EXPECT_EQ(bus.messages.back().payload, "2999");
}

TEST(MqttTls, Stopped_SaysGoodbye) {
    MosquittoBroker broker({.tls = true});
    BusProbe probe(broker.port(), {"#"}, {.ca = broker.certificates().ca});
    auto options = tls_options(broker);
    options.will = make_message("state", "lost", 1);
    Recorder bus(options);
    ASSERT_TRUE(bus.connect());
    bus.client->publish(make_message("state", "offline", 1));
    bool stopped = false;
    bus.client->stop(2s, [&] { stopped = true; });
    ASSERT_TRUE(bus.until([&] { return stopped; }));
    ASSERT_TRUE(probe.wait_for("state", "offline"));
    probe.publish("end", "x");
    ASSERT_TRUE(probe.wait_for("end"));
    EXPECT_EQ(probe.count("state"), 1u);
}

}  // namespace
}  // namespace asip::test
