// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/options.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

#include "asip/text/printable.hpp"

namespace asip::mqtt {
namespace {

Expected<std::uint16_t> parse_port(std::string_view text) {
    unsigned port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size() || port == 0 || port > 65535)
        return fail("\"" + std::string(text) + "\" is not a port (1 to 65535)");
    return static_cast<std::uint16_t>(port);
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text.remove_prefix(prefix.size());
    return true;
}

}  // namespace

std::string BrokerAddress::describe() const {
    const bool v6 = host.find(':') != std::string::npos;
    return std::string(tls ? "mqtts://" : "mqtt://") + (v6 ? "[" + host + "]" : host) + ":" +
           std::to_string(port);
}

Expected<BrokerAddress> parse_broker(std::string_view text) {
    const std::string given = text::without_credentials(text);
    if (given != text) {
        return fail(
            "broker \"" + given +
            "\": an address holds neither user nor password; give them by --user and --password-file");
    }
    BrokerAddress address;
    if (take_prefix(text, "mqtts://") || take_prefix(text, "ssl://")) {
        address.tls = true;
        address.port = 8883;
    } else if (!take_prefix(text, "mqtt://") && !take_prefix(text, "tcp://") &&
               text.find("://") != std::string_view::npos) {
        return fail("broker \"" + given + "\": only mqtt:// and mqtts:// are supported");
    }
    while (text.ends_with('/'))
        text.remove_suffix(1);
    std::string_view port;
    if (text.starts_with('[')) {
        const auto close = text.find(']');
        if (close == std::string_view::npos) return fail("broker \"" + given + "\": the ] is missing");
        port = text.substr(close + 1);
        text = text.substr(1, close - 1);
        if (!port.empty() && !take_prefix(port, ":"))
            return fail("broker \"" + given + "\" is not HOST:PORT");
        if (port.empty() && given.ends_with(':'))
            return fail("broker \"" + given + "\": the port is missing");
    } else if (const auto colon = text.find(':'); colon != std::string_view::npos) {
        if (text.find(':', colon + 1) != std::string_view::npos) {
            return fail("broker \"" + given + "\": an IPv6 address stands in brackets, as in [" +
                        (text.find_first_not_of("0123456789abcdefABCDEF:.") == std::string_view::npos
                             ? std::string(text)
                             : std::string("2001:db8::1")) +
                        "]:1883");
        }
        port = text.substr(colon + 1);
        text = text.substr(0, colon);
        if (port.empty()) return fail("broker \"" + given + "\": the port is missing");
    }
    if (text.empty() || text.find_first_of("/@ \t") != std::string_view::npos)
        return fail("broker \"" + given + "\" is not HOST, HOST:PORT or mqtt://HOST:PORT");
    address.host = text;
    if (!port.empty()) {
        const auto number = parse_port(port);
        if (!number) return fail("broker \"" + given + "\": " + number.error());
        address.port = *number;
    }
    return address;
}

Expected<std::string> read_password_file(const std::string& path) {
    errno = 0;
    std::ifstream file(path);
    const std::string the_file = "the password file " + path;
    if (!file)
        return fail(the_file + " cannot be read" +
                    (errno != 0 ? ": " + std::string(std::strerror(errno)) : ""));
    std::string password;
    std::getline(file, password);
    if (file.bad()) return fail(the_file + " cannot be read; is it a folder?");
    if (password.ends_with('\r')) password.pop_back();
    if (password.starts_with("\xef\xbb\xbf")) password.erase(0, 3);  // as some editors begin a file
    if (password.empty()) return fail(the_file + " has no password in its first line");
    if (password.find('\0') != std::string::npos)
        return fail(the_file +
                    " is no plain text: save it as UTF-8, with the password alone in its first line");
    if (password.starts_with("user ") || password.find(":$") != std::string::npos)
        return fail(the_file +
                    " seems to be a file of a broker or of credentials: the first line of a password file is "
                    "the password alone; a file made by asipctl secure goes to --credentials");
    return password;
}

}  // namespace asip::mqtt
