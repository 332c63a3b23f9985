// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>

#include "asip/model/names.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/printable.hpp"
#include "gateway/application.hpp"

namespace asip::gateway {
namespace {

int refuse(const std::string& text) {
    std::cerr << "asip-gateway: " << text << "\n";
    return program::kExitUsage;
}

// Readable by its owner only from its first byte.
bool append(const std::string& path, const std::string& line) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (file < 0) return false;
    const bool written = write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size());
    return close(file) == 0 && written;
}

}  // namespace

int make_token(const TokenRequest& request) {
    auto rights = parse_role(request.role);
    if (!rights) return refuse(rights.error());
    if (!model::valid_name(request.name))
        return refuse("\"" + text::printable(request.name) +
                      "\" is not a name: 1 to 64 of A-Z a-z 0-9 . _ -");
    rights->name = request.name;
    rights->boards = request.boards;
    rights->services = request.services;
    rights->frames = request.frames;
    if (!rights->frames.empty() && rights->role != Role::kKiosk) return refuse("--frames: only for a kiosk");
    if (rights->role == Role::kKiosk && rights->boards.empty())
        return refuse("a kiosk shows one board or service: name it with --boards, and --services");
    if (!request.until.empty()) {
        const auto period = text::parse_duration(request.until);
        if (!period) return refuse("--until: " + period.error());
        rights->until = text::wall_now() + *period;
    }
    std::string before;
    if (std::filesystem::exists(request.file)) {
        const auto known = Tokens::read(request.file);
        if (!known) return refuse(known.error());
        if (known->named(request.name) != nullptr)
            return refuse("a token is called " + request.name +
                          " already; take its line out of the file first");
    }
    const auto secret = random_secret(32);
    const auto line = token_line(*rights, hash_of(secret));
    if (const auto check = Tokens::parse(line); !check) return refuse(check.error());
    if (!append(request.file, line + "\n")) return refuse("cannot write " + request.file);
    std::cout << secret << "\n";
    std::cerr << "This token is not shown again. "
              << (rights->role == Role::kKiosk ? "The link is http://GATEWAY/kiosk/TOKEN/"
                                               : "Use it as: Authorization: Bearer TOKEN")
              << "\n";
    return program::kExitOk;
}

}  // namespace asip::gateway
