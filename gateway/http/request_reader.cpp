// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/request_reader.hpp"

#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

namespace asip::gateway::http {
namespace {

namespace beast_http = boost::beast::http;
using beast_http::error;

std::string_view view(boost::beast::string_view text) {
    return {text.data(), text.size()};
}

RequestReader::Error error_for(const boost::beast::error_code& code) {
    if (code == error::header_limit) return {431, "the head of the request is too long"};
    if (code == error::body_limit) return {413, "the body of the request is too long"};
    if (code == error::bad_version) return {505, "not HTTP/1.0 or HTTP/1.1"};
    return {400, "the request is not valid HTTP"};
}

}  // namespace

struct RequestReader::State {
    beast_http::request_parser<beast_http::string_body> parser;
    std::optional<Error> error;
    bool continue_asked = false;
    bool head_read = false;
    std::vector<std::pair<std::string, std::string>> headers;

    void read_head();
};

// Once the head is there and nothing behind it has been read: fields behind a chunked body come without what
// the fields of the head were checked for, and are left out.
void RequestReader::State::read_head() {
    head_read = true;
    parser.eager(true);
    const auto& head = parser.get();
    for (const auto& field : head)
        headers.emplace_back(lower(view(field.name_string())), std::string(field.value()));
    const bool encoded = head.count(beast_http::field::transfer_encoding) > 0;
    if (encoded && head.count(beast_http::field::content_length) > 0)
        error = Error{400, "Content-Length and Transfer-Encoding exclude each other"};
    else if (encoded && head.version() == 10)
        error = Error{400, "HTTP/1.0 has no Transfer-Encoding; send Content-Length"};
    else if (encoded && lower(view(head[beast_http::field::transfer_encoding])) != "chunked")
        error = Error{501, "the only Transfer-Encoding that is understood is chunked"};
    else if (head.count(beast_http::field::host) > 1)
        error = Error{400, "more than one Host"};
}

RequestReader::RequestReader(Limits limits) : state_(std::make_unique<State>()) {
    state_->parser.header_limit(static_cast<std::uint32_t>(limits.header_bytes));
    state_->parser.body_limit(limits.body_bytes);
}

RequestReader::~RequestReader() = default;
RequestReader::RequestReader(RequestReader&&) noexcept = default;
RequestReader& RequestReader::operator=(RequestReader&&) noexcept = default;

std::size_t RequestReader::feed(std::string_view bytes) {
    // Beast 1.74 asserts that what follows the size of the last chunk comes in at least five bytes. Every
    // chunked body ends with five ("0", two line ends), so waiting for them loses nothing.
    if (bytes.size() < 5 && head_done() && !done() && state_->parser.chunked()) return 0;
    boost::beast::error_code code;
    const std::size_t used = state_->parser.put(boost::asio::buffer(bytes.data(), bytes.size()), code);
    if (code && code != error::need_more) state_->error = error_for(code);
    if (!state_->error && !state_->head_read && state_->parser.is_header_done()) state_->read_head();
    return used;
}

bool RequestReader::done() const {
    return state_->parser.is_done();
}

bool RequestReader::head_done() const {
    return state_->parser.is_header_done();
}

bool RequestReader::wants_continue() {
    if (state_->continue_asked || !head_done() || done()) return false;
    state_->continue_asked = true;
    const auto& head = state_->parser.get();
    return head.version() > 10 && lower(view(head[beast_http::field::expect])) == "100-continue";
}

const std::optional<RequestReader::Error>& RequestReader::error() const {
    return state_->error;
}

Request RequestReader::take() {
    auto message = state_->parser.release();
    Request request;
    request.method = std::string(message.method_string());
    request.target = std::string(message.target());
    request.headers = std::move(state_->headers);
    request.body = std::move(message.body());
    request.keep_alive = message.keep_alive();
    request.http_1_0 = message.version() == 10;
    if (!split_target(request)) request.segments = {""};
    return request;
}

}  // namespace asip::gateway::http
