// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/tokens.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "asip/model/names.hpp"
#include "asip/text/file_text.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1u << 20;

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    while (!text.empty()) {
        const auto at = text.find(separator);
        if (at != 0) parts.emplace_back(text.substr(0, at));
        text = at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
    }
    return parts;
}

bool is_hash(std::string_view text) {
    return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

Expected<void> read_member(Rights& rights, const std::string& word) {
    const auto equals = word.find('=');
    const auto name = word.substr(0, equals);
    const auto value = equals == std::string::npos ? std::string() : word.substr(equals + 1);
    if (value.empty()) return fail("\"" + word + "\" is not NAME=VALUE");
    if (name == "until") {
        rights.until = text::parse_iso_time(value);
        if (!rights.until) return fail("\"" + value + "\" is not a time such as 2027-01-31");
    } else if (name == "boards") {
        rights.boards = split(value, ',');
    } else if (name == "services") {
        rights.services = split(value, ',');
    } else if (name == "frames") {
        rights.frames = split(value, ',');
    } else if (name == "dashboard") {
        if (rights.role != Role::kKiosk) return fail("dashboard=: only for a kiosk");
        if (!model::valid_name(value)) return fail("\"" + value + "\" is not a name of a dashboard");
        rights.dashboard = value;
    } else if (name == "control") {
        if (value != "yes" && value != "no") return fail("control: must be yes or no");
        rights.control = value == "yes";
    } else {
        return fail("\"" + name + "\" is none of until, boards, services, frames, dashboard and control");
    }
    return {};
}

std::string joined(const std::vector<std::string>& parts) {
    std::string text;
    for (const auto& part : parts)
        text += (text.empty() ? "" : ",") + part;
    return text;
}

}  // namespace

Expected<Tokens> Tokens::parse(std::string_view text) {
    Tokens tokens;
    std::istringstream lines{std::string(text)};
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        const auto words = split(line, ' ');
        if (words.empty() || words[0].front() == '#') continue;
        const auto wrong = [&](const std::string& why) {
            return fail("line " + std::to_string(number) + ": " + why);
        };
        if (words.size() < 3) return wrong("expected ROLE NAME HASH");
        auto rights = parse_role(words[0]);
        if (!rights) return wrong(rights.error());
        rights->name = words[1];
        if (!model::valid_name(rights->name)) return wrong("\"" + words[1] + "\" is not a name");
        if (is_reserved(rights->name)) return wrong("no token may be called \"" + words[1] + "\"");
        if (!is_hash(words[2]))
            return wrong("the third word is not a hash; make lines with asip-gateway token");
        if (tokens.named(rights->name) != nullptr) return wrong("a second token is called " + words[1]);
        for (std::size_t i = 3; i < words.size(); ++i)
            if (auto member = read_member(*rights, words[i]); !member) return wrong(member.error());
        if (rights->control && rights->dashboard.empty()) return wrong("control=yes needs dashboard=NAME");
        if (!rights->dashboard.empty() && !(rights->boards.empty() && rights->services.empty()))
            return wrong("dashboard=NAME says what is seen; leave out boards and services");
        rights->token_hash = words[2];
        tokens.tokens_.push_back(std::move(*rights));
    }
    return tokens;
}

bool Tokens::is_reserved(std::string_view name) {
    return name == "loopback" || name == "anonymous" || name == "nobody";
}

Expected<std::string> Tokens::text_of(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return fail("there is no tokens file " + path);
    if (const auto size = std::filesystem::file_size(path, error); error || size > kMaxFileBytes)
        return fail("the tokens file " + path + " is longer than 1 MiB");
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) {
        return fail("cannot read the tokens file " + path +
                    "; its owner or its group must be those that asip-gateway runs as");
    }
    return text.str();
}

Expected<Tokens> Tokens::read(const std::string& path) {
    const auto text = text_of(path);
    if (!text) return Unexpected<std::string>(text.error());
    auto tokens = parse(std::string(text::without_mark(*text)));
    if (!tokens) return fail(path + ", " + tokens.error());
    return tokens;
}

const Rights* Tokens::find(std::string_view token) const {
    if (token.empty()) return nullptr;
    const auto hash = hash_of(token);
    const Rights* found = nullptr;
    for (const auto& each : tokens_)
        if (equal_in_constant_time(each.token_hash, hash)) found = &each;
    return found;
}

const Rights* Tokens::named(std::string_view name) const {
    const auto found =
        std::find_if(tokens_.begin(), tokens_.end(), [&](const Rights& each) { return each.name == name; });
    return found == tokens_.end() ? nullptr : &*found;
}

std::string token_line(const Rights& rights, std::string_view hash) {
    std::string line = std::string(to_string(rights.role)) + (rights.raw ? "+raw" : "") + " " + rights.name +
                       " " + std::string(hash);
    if (rights.until) line += " until=" + text::iso_time(*rights.until);
    if (!rights.boards.empty()) line += " boards=" + joined(rights.boards);
    if (!rights.services.empty()) line += " services=" + joined(rights.services);
    if (!rights.frames.empty()) line += " frames=" + joined(rights.frames);
    if (!rights.dashboard.empty()) line += " dashboard=" + rights.dashboard;
    if (rights.control) line += " control=yes";
    return line;
}

}  // namespace asip::gateway
