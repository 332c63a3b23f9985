// SPDX-License-Identifier: Apache-2.0
// Targets that are no path: in absolute form, as a proxy's clients send them, and the asterisk.
#include "api_bench.hpp"
#include "gateway/http/request_reader.hpp"

namespace asip::gateway {
namespace {

TEST_F(ApiTest, AuthorityOfTheTarget_ReplacesHostBeforeItIsChecked) {
    announce();
    struct Row {
        const char* line;
        const char* headers;
        int status;
    };
    const char* const evil = "Host: evil.example\r\n";
    const char* const ours = "Host: localhost\r\n";
    const char* const own_origin = "Host: evil.example\r\nOrigin: http://localhost:8080\r\n";
    const char* const evil_origin = "Host: evil.example\r\nOrigin: http://evil.example\r\n";
    for (const auto& row : {
             Row{"GET http://localhost:8080/api/boards/uno1", evil, 200},
             Row{"GET http://localhost:8080", evil, 200},
             Row{"GET http://evil.example/api/boards", ours, 421},
             Row{"GET http://me@localhost/api/boards", ours, 400},
             Row{"GET https://localhost/api/boards", ours, 421},
             Row{"PUT http://localhost:8080/api/boards/uno1", own_origin, 405},
             Row{"PUT http://localhost:8080/api/boards/uno1", evil_origin, 403},
             Row{"OPTIONS *", ours, 204},
             Row{"OPTIONS *", evil, 421},
             Row{"OPTIONS http://localhost:8080", evil, 204},
             Row{"OPTIONS /", ours, 204},
             Row{"GET *", ours, 400},
         }) {
        http::RequestReader reader({});
        const std::string bytes =
            row.line + std::string(" HTTP/1.1\r\nContent-Type: application/json\r\n") + row.headers + "\r\n";
        reader.feed(bytes);
        ASSERT_TRUE(reader.done()) << row.line;
        auto request = reader.take();
        request.peer = {"127.0.0.1", true, false};
        const auto captured = std::make_shared<Captured>();
        gateway_->request(request, http::Reply(captured, 1));
        EXPECT_EQ(captured->status(), row.status) << row.line << "\n" << row.headers;
        if (request.is_asterisk() && row.status == 204) {
            EXPECT_EQ(captured->header("Allow"), "GET, HEAD, POST, PUT, DELETE, OPTIONS");
        }
    }
}

}  // namespace
}  // namespace asip::gateway
