// SPDX-License-Identifier: Apache-2.0
#include "asip/program/credentials.hpp"

#include <fstream>
#include <sstream>

#include "asip/program/config_file.hpp"
#include "asip/text/file_text.hpp"
#include "asip/text/nearest.hpp"

namespace asip::program {
namespace {

constexpr std::size_t kMaxCredentialBytes = 1u << 20;
constexpr std::string_view kBegin = "-----BEGIN ";
constexpr std::string_view kEnd = "-----END ";

std::vector<std::string> parts_of(const std::string& list) {
    std::vector<std::string> parts;
    std::istringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');)
        if (const auto name = trimmed(part); !name.empty()) parts.push_back(name);
    return parts;
}

Expected<void> take_line(const std::string& line, Credentials& made) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) return fail("expected NAME = VALUE");
    const auto name = trimmed(std::string_view(line).substr(0, equals));
    const auto value = trimmed(std::string_view(line).substr(equals + 1));
    if (name == "broker") {
        made.brokers = parts_of(value);
    } else if (name == "user") {
        made.user = value;
    } else if (name == "password") {
        made.password = value;
    } else if (name == "topic-root") {
        made.topic_root = value;
    } else if (name == "name") {
        made.name = value;
    } else if (name != "role") {
        return fail("credentials have no \"" + name + "\"" +
                    text::did_you_mean(name, std::vector<std::string>{"broker", "user", "password",
                                                                      "topic-root", "name", "role"}));
    }
    return {};
}

Expected<void> check_complete(const Credentials& made) {
    if (made.brokers.empty()) return fail("the line broker = ... is missing");
    if (made.user.empty()) return fail("the line user = ... is missing");
    if (made.password.empty()) return fail("the line password = ... is missing");
    return {};
}

}  // namespace

Expected<Credentials> parse_credentials(const std::string& text, const std::string& source) {
    Credentials made;
    std::istringstream lines(text);
    bool inside = false;
    int number = 0;
    for (std::string raw; std::getline(lines, raw);) {
        ++number;
        const auto line = trimmed(raw);
        if (line.starts_with(kBegin)) {
            inside = true;
            made.certificate = made.certificate || line == "-----BEGIN CERTIFICATE-----";
        } else if (inside) {
            inside = !line.starts_with(kEnd);
        } else if (!line.empty() && line.front() != '#') {
            if (const auto taken = take_line(line, made); !taken)
                return fail(source + ":" + std::to_string(number) + ": " + taken.error());
        }
    }
    if (inside) return fail(source + ": a certificate has no end; was the file copied whole?");
    if (const auto complete = check_complete(made); !complete) return fail(source + ": " + complete.error());
    return made;
}

Expected<Credentials> read_credentials(const std::string& path) {
    std::ifstream file(path);
    if (!file) return fail("cannot read the credentials " + path);
    std::string text(kMaxCredentialBytes + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (file.bad() || text.size() > kMaxCredentialBytes) return fail(path + " is too long for credentials");
    if (text::is_utf16(text)) return fail(path + " is in UTF-16: save it as UTF-8");
    return parse_credentials(std::string(text::without_mark(text)), path);
}

}  // namespace asip::program
