// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "asip/model/names.hpp"
#include "asip/program/config_file.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/printable.hpp"
#include "gateway/application.hpp"
#include "gateway/dashboard/dashboard.hpp"
#include "gateway/replaced_file.hpp"

namespace asip::gateway {
namespace {

int refuse(const std::string& text) {
    std::cerr << "asip-gateway: " << text << "\n";
    return program::kExitUsage;
}

// As written in a list: blanks around a name are none of it.
std::vector<std::string> without_blanks(const std::vector<std::string>& words) {
    std::vector<std::string> result;
    for (const auto& word : words)
        result.push_back(program::trimmed(word));
    return result;
}

Expected<void> check_patterns(const char* option, const std::vector<std::string>& patterns) {
    for (const auto& pattern : patterns) {
        auto name = pattern;
        std::replace_if(name.begin(), name.end(), [](char c) { return c == '*' || c == '?'; }, 'x');
        if (!model::valid_name(name))
            return fail(std::string(option) + ": no name is like \"" + text::printable(pattern) +
                        "\": 1 to 64 of A-Z a-z 0-9 . _ -, and * and ? as in a shell");
    }
    return {};
}

// What stands in one word of the file must be one.
Expected<void> check_origins(const std::vector<std::string>& origins) {
    for (const auto& origin : origins)
        if (origin.empty() || origin.find_first_of(" \t\r\n\v\f") != std::string::npos)
            return fail("--frames: \"" + text::printable(origin) +
                        "\" is not an origin such as https://HOST");
    return {};
}

Expected<void> check_dashboard(const TokenRequest& request, Rights& rights) {
    rights.dashboard = request.dashboard;
    rights.control = request.control;
    if (request.dashboard.empty()) {
        if (request.control) return fail("--control: only with --dashboard");
        return {};
    }
    if (rights.role != Role::kKiosk) return fail("--dashboard: only for a kiosk");
    if (!valid_dashboard_name(request.dashboard))
        return fail("--dashboard: \"" + text::printable(request.dashboard) + "\": " + kDashboardNameForm);
    if (!request.boards.empty() || !request.services.empty())
        return fail("--dashboard says what is seen; leave out --boards and --services");
    return {};
}

}  // namespace

int make_token(const TokenRequest& request) {
    auto rights = parse_role(request.role);
    if (!rights) return refuse(rights.error());
    if (!model::valid_name(request.name))
        return refuse("\"" + text::printable(request.name) +
                      "\" is not a name: 1 to 64 of A-Z a-z 0-9 . _ -");
    if (Tokens::is_reserved(request.name))
        return refuse("\"" + request.name +
                      "\" is what those without a token are called; choose another name");
    rights->name = request.name;
    rights->boards = without_blanks(request.boards);
    rights->services = without_blanks(request.services);
    rights->frames = without_blanks(request.frames);
    for (const auto& checked :
         {check_patterns("--boards", rights->boards), check_patterns("--services", rights->services),
          check_origins(rights->frames)})
        if (!checked) return refuse(checked.error());
    if (!rights->frames.empty() && rights->role != Role::kKiosk) return refuse("--frames: only for a kiosk");
    if (auto shown = check_dashboard(request, *rights); !shown) return refuse(shown.error());
    if (rights->role == Role::kKiosk && rights->boards.empty() && rights->dashboard.empty())
        return refuse(
            "a kiosk shows one board, service or dashboard: name it with --boards, and --services, or with "
            "--dashboard");
    if (!request.until.empty()) {
        const auto period = text::parse_duration(request.until);
        if (!period) return refuse("--until: " + period.error());
        rights->until = text::wall_now() + *period;
    }
    std::string text;
    if (std::error_code error; std::filesystem::exists(request.file, error)) {
        auto read = Tokens::text_of(request.file);
        if (!read) return refuse(read.error());
        text = std::move(*read);
        const auto known = Tokens::parse(text);
        if (!known) return refuse(request.file + ", " + known.error());
        if (known->named(request.name) != nullptr)
            return refuse("a token is called " + request.name +
                          " already; take its line out of the file first");
    }
    const auto secret = random_secret(32);
    const auto line = token_line(*rights, hash_of(secret));
    if (const auto check = Tokens::parse(line); !check) return refuse(check.error());
    if (!text.empty() && text.back() != '\n') text += '\n';
    if (!replace_file(request.file, text + line + "\n"))
        return refuse("cannot write " + request.file + ": " + std::strerror(errno));
    std::cout << secret << "\n";
    std::cerr << "This token is not shown again. "
              << (rights->role == Role::kKiosk ? "The link is http://GATEWAY/kiosk/TOKEN/"
                                               : "Type it at Sign in, on the gateway's page; a program sends "
                                                 "it as the header Authorization: Bearer TOKEN")
              << "\n";
    return program::kExitOk;
}

}  // namespace asip::gateway
