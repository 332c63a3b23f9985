// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "http_client.hpp"

namespace asip::bench {

using Seconds = std::chrono::duration<double>;

/// etcd over its gRPC gateway: HTTP and JSON, one request after the other over one connection. Throws
/// std::runtime_error for anything but success.
class EtcdClient {
  public:
    explicit EtcdClient(std::uint16_t port) : wire_(port) {}

    /// Whether it takes requests.
    static bool answers(std::uint16_t port) {
        try {
            EtcdClient(port).get("nothing");
            return true;
        } catch (const std::exception&) {
            return false;
        }
    }

    void grant(std::uint64_t lease, int seconds) {
        call("lease/grant",
             R"({"ID":)" + std::to_string(lease) + R"(,"TTL":)" + std::to_string(seconds) + "}");
    }
    void keep_alive(std::uint64_t lease) {
        call("lease/keepalive", R"({"ID":)" + std::to_string(lease) + "}");
    }
    /// All in one transaction.
    void put(std::uint64_t lease, const std::vector<std::pair<std::string, std::string>>& pairs) {
        std::string body = R"({"success":[)";
        for (const auto& [key, value] : pairs) {
            if (body.back() == '}') body += ',';
            body += R"({"requestPut":{"key":")" + base64(key) + R"(","value":")" + base64(value) +
                    R"(","lease":)" + std::to_string(lease) + "}}";
        }
        call("kv/txn", body + "]}");
    }
    std::string get(const std::string& key) { return call("kv/range", R"({"key":")" + base64(key) + "\"}"); }
    std::string range(const std::string& from, const std::string& to, int limit) {
        return call("kv/range", R"({"key":")" + base64(from) + R"(","range_end":")" + base64(to) +
                                    R"(","limit":)" + std::to_string(limit) + "}");
    }

  private:
    std::string call(const std::string& what, const std::string& body) {
        wire_.send("POST /v3/" + what + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                   std::to_string(body.size()) + "\r\n\r\n" + body);
        auto answer = test::read_answer(wire_);
        if (answer.headers.count("transfer-encoding") > 0) answer.body = wire_.read_until("\r\n0\r\n\r\n");
        if (answer.status != 200) throw std::runtime_error("etcd answers " + what + ": " + answer.body);
        return answer.body;
    }

    static std::string base64(const std::string& text) {
        static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string result;
        for (std::size_t i = 0; i < text.size(); i += 3) {
            unsigned bits = 0;
            for (std::size_t k = 0; k < 3; ++k)
                bits = bits << 8 | (i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0u);
            for (std::size_t k = 0; k < 4; ++k)
                result += k <= text.size() - i ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
        }
        return result;
    }

    test::Wire wire_;
};

}  // namespace asip::bench
