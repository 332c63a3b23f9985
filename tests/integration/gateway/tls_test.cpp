// SPDX-License-Identifier: Apache-2.0
// TLS with a chain: root, intermediate, server.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

class GatewayTls : public testing::Test {
  protected:
    void openssl(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "openssl");
        const auto done = run(arguments);
        ASSERT_EQ(done.status, 0) << done.errors;
    }
    std::string file(const std::string& name) const { return folder_.file(name); }
    void request(const std::string& name, const std::string& subject) {
        openssl({"req", "-new", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                 "-subj", subject, "-keyout", file(name + ".key"), "-out", file(name + ".csr")});
    }
    void sign(const std::string& name, const std::string& by, const std::string& extensions) {
        const auto path = folder_.write(name + ".ext", extensions);
        openssl({"x509", "-req", "-in", file(name + ".csr"), "-CA", file(by + ".pem"), "-CAkey",
                 file(by + ".key"), "-CAcreateserial", "-days", "2", "-extfile", path, "-out",
                 file(name + ".pem")});
    }
    void SetUp() override {
        openssl({"req", "-x509", "-new", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
                 "-nodes", "-days", "2", "-subj", "/CN=Test root", "-keyout", file("root.key"), "-out",
                 file("root.pem")});
        request("middle", "/CN=Test intermediate");
        sign("middle", "root", "basicConstraints=critical,CA:true\n");
        request("server", "/CN=localhost");
        sign("server", "middle", "subjectAltName=DNS:localhost,IP:127.0.0.1\n");
        openssl({"x509", "-in", file("server.pem"), "-out", file("chain.pem")});
        std::string chain;
        for (const char* part : {"server.pem", "middle.pem"})
            chain += run({"cat", file(part)}).output;
        folder_.write("chain.pem", chain);
    }
    Finished curl(std::uint16_t port, std::vector<std::string> more) {
        std::vector<std::string> all{"curl", "-s", "-S",
                                     "https://localhost:" + std::to_string(port) + "/healthz"};
        all.insert(all.end(), more.begin(), more.end());
        return run(all);
    }

    TempDir folder_;
    MosquittoBroker broker_;
};

TEST_F(GatewayTls, Chain_IsAcceptedByWhoeverTrustsTheRoot) {
    RunningGateway gateway(broker_.address(),
                           {"--http-cert", file("chain.pem"), "--http-key", file("server.key")});
    const auto trusted = curl(gateway.port(), {"--cacert", file("root.pem")});
    EXPECT_EQ(trusted.output, R"({"status":"ok"})") << trusted.errors;
    EXPECT_NE(curl(gateway.port(), {}).status, 0) << "not by others";
    EXPECT_NE(curl(gateway.port(), {"--cacert", file("root.pem"), "--tls-max", "1.1"}).status, 0);
    EXPECT_EQ(curl(gateway.port(), {"--cacert", file("root.pem"), "--tls-max", "1.2"}).status, 0);
}

TEST_F(GatewayTls, PlainHttp_IsLedToHttps_AndTheNextIsServed) {
    RunningGateway gateway(broker_.address(),
                           {"--http-cert", file("chain.pem"), "--http-key", file("server.key"), "--config",
                            settings_file("header-time = 1s\n")});
    Wire plain(gateway.port());
    plain.send("GET /join?a=1 HTTP/1.1\r\nHost: school.example:8443\r\n\r\n");
    const auto head = plain.read_until("\r\n\r\n");
    EXPECT_THAT(head, testing::StartsWith("HTTP/1.1 307 "));
    EXPECT_THAT(head, testing::HasSubstr("Location: https://school.example:8443/join?a=1\r\n"));
    EXPECT_TRUE(plain.closed());
    for (const char* wrong : {"POST /api/stop HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n",
                              "GET / HTTP/1.1\r\nHost: a@b\r\n\r\n", "GET / HTTP/1.0\r\n\r\n"}) {
        Wire other(gateway.port());
        other.send(wrong);
        EXPECT_THAT(other.read_until("\r\n\r\n"), testing::StartsWith("HTTP/1.1 400 ")) << wrong;
        EXPECT_TRUE(other.closed());
    }
    Wire neither(gateway.port());
    neither.send("hello\r\n\r\n");
    EXPECT_TRUE(neither.closed());
    Wire silent(gateway.port());
    EXPECT_TRUE(silent.closed(std::chrono::seconds(5))) << "a handshake that does not begin";
    EXPECT_EQ(curl(gateway.port(), {"--cacert", file("root.pem")}).status, 0);
}

TEST_F(GatewayTls, ManyHandshakesOfOneAddress_AreTurnedAwayAndOthersAreServed) {
    RunningGateway gateway(broker_.address(),
                           {"--http-cert", file("chain.pem"), "--http-key", file("server.key")});
    const std::vector<std::string> trust{"--cacert", file("root.pem")};
    {
        std::vector<std::unique_ptr<Wire>> silent;
        for (int i = 0; i < 64; ++i)
            silent.push_back(std::make_unique<Wire>(gateway.port()));
        EXPECT_TRUE(wait_until([&] { return Wire(gateway.port()).closed(std::chrono::milliseconds(500)); }));
        EXPECT_NE(curl(gateway.port(), trust).status, 0);
        EXPECT_EQ(curl(gateway.port(), {"--cacert", file("root.pem"), "--interface", "127.0.0.2"}).status, 0);
    }
    EXPECT_TRUE(wait_until([&] { return curl(gateway.port(), trust).status == 0; }));
}

TEST_F(GatewayTls, KeyOfAnotherCertificate_DoesNotStart) {
    const auto refused =
        run({ASIP_PROGRAMS "/asip-gateway", "--broker", broker_.address(), "--http", "127.0.0.1:0",
             "--http-cert", file("chain.pem"), "--http-key", file("root.key")});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, testing::HasSubstr("cannot use"));
}

}  // namespace
}  // namespace asip::test
