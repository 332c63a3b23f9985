// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/users.hpp"

#include <algorithm>

#include "asip/program/credentials.hpp"
#include "asip/text/file_text.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/secure/leftovers.hpp"
#include "cli/secure/secrets.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kSaltBytes = 12;

SecuredUser made_user(const std::string& name, Role role, const std::string& password) {
    return {name, role, mosquitto_hash(password, random_bytes(kSaltBytes)), text::iso_time(text::wall_now())};
}

/// True: they are not as they were.
Outcome<bool> write_credentials(const SecureFolder& folder, const SecuredBus& bus, const SecuredUser& user,
                                const std::string& password) {
    const auto authority = text::file_text(folder.authority());
    if (!authority) return failure(program::kExitFailure, "cannot read " + folder.authority().string());
    return folder.write(folder.credentials(user.name), credentials_text(bus, user, password, *authority),
                        SecureFolder::Readers::kOwner);
}

std::string who(const SecuredUser& user) {
    std::string text = std::string(name_of(user.role)) + " " + user.name;
    if (user.boards) text += " of " + (user.boards->empty() ? "no board" : listed(*user.boards));
    return text;
}

}  // namespace

Outcome<void> ensure_user(const SecureFolder& folder, SecuredBus& bus, const std::string& name, Role role,
                          SecureReport& report) {
    if (const auto why = explain_user_name(name, role); !why.empty())
        return failure(program::kExitUsage, why);
    const auto file = folder.credentials(name);
    const bool has_file = std::filesystem::exists(file);
    if (const auto* user = bus.find(name)) {
        if (user->role != role)
            return failure(program::kExitFailure, name + " is a name in use, by the " +
                                                      std::string(name_of(user->role)) +
                                                      "; take another, or revoke that one first");
        if (has_file) {
            report.did("kept", who(*user), file);
        } else {
            report.did("kept", who(*user) +
                                   "; its credentials are no longer here (new ones: asipctl secure renew " +
                                   name + ")");
        }
        return {};
    }
    std::string password = random_password();
    if (has_file) {
        const auto read = program::read_credentials(file);
        if (!read) return failure(program::kExitFailure, read.error());
        if (read->user == name) password = read->password;
    }
    const auto user = made_user(name, role, password);
    // What was interrupted may have been the addition for another role, or with other addresses.
    if (auto done = write_credentials(folder, bus, user, password); !done)
        return tl::unexpected(done.error());
    bus.users.push_back(user);
    report.did("made", "credentials of " + who(user), file);
    return {};
}

void give_boards(SecuredBus& bus, const std::string& name, const std::set<std::string>& boards,
                 const std::string& selector, SecureReport& report) {
    const auto user = std::find_if(bus.users.begin(), bus.users.end(),
                                   [&name](const auto& one) { return one.name == name; });
    const bool same = user->boards == boards && user->selector == selector;
    user->boards = boards;
    user->selector = selector;
    report.did(same ? "kept" : "changed", "boards that " + name + " commands, which have the labels " +
                                              selector + ": " + listed(boards));
}

Outcome<SomeBoards> labelled_boards(const SelectorText& selector, const std::vector<std::string>& operators,
                                    const Environment& environment, const SecureFolder& folder,
                                    const SecuredBus& bus) {
    if (!selector) return SomeBoards();
    for (const auto& name : operators)
        if (const auto* user = bus.find(name);
            user != nullptr && user->role == Role::kOperator && !user->boards)
            return failure(program::kExitFailure,
                           name +
                               " commands every board, and its links would go on doing so; first: asipctl "
                               "secure revoke " +
                               name);
    const auto labels = parse_selector(selector);
    if (!labels) return tl::unexpected(labels.error());
    auto mqtt = options_of(folder, "admin");
    if (!mqtt) return tl::unexpected(mqtt.error());
    Environment admin = environment;
    admin.mqtt = std::move(*mqtt);
    admin.topics = bus::Topics(bus.topic_root);
    BusSession session(admin);
    BoardSource source(admin, session);
    if (auto connected = session.connect(); !connected) return tl::unexpected(connected.error());
    const auto found = choose_boards(source, {.board = "*", .service = {}}, *labels);
    if (!found) return tl::unexpected(found.error());
    std::set<std::string> names;
    // A registry could announce a board where something else of the bus is, such as reply.
    for (const auto& [item, description, fault] : *found)
        if (const auto* user = bus.find(item.board); user != nullptr && user->role == Role::kBoard)
            names.insert(item.board);
    if (names.empty())
        return failure(program::kExitFailure, "no board with labels " + labels->text() +
                                                  " has credentials of this bus: asipctl secure show");
    return names;
}

Outcome<void> check_known(const SecuredBus& bus, const std::string& name) {
    if (bus.find(name) != nullptr) return {};
    std::vector<std::string> names;
    for (const auto& user : bus.users)
        names.push_back(user.name);
    return failure(program::kExitFailure,
                   "no user on this bus is called " + name + text::did_you_mean(name, names));
}

Outcome<void> renew_user(const SecureFolder& folder, SecuredBus& bus, const std::string& name,
                         SecureReport& report) {
    if (auto known = check_known(bus, name); !known) return known;
    const auto user = std::find_if(bus.users.begin(), bus.users.end(),
                                   [&name](const auto& one) { return one.name == name; });
    const auto password = random_password();
    *user = made_user(name, user->role, password);
    if (auto done = write_credentials(folder, bus, *user, password); !done)
        return tl::unexpected(done.error());
    report.did("changed", "credentials of " + who(*user), folder.credentials(name));
    return {};
}

Outcome<void> remove_user(const SecureFolder& folder, SecuredBus& bus, const std::string& name,
                          SecureReport& report) {
    if (auto known = check_known(bus, name); !known) return known;
    // First of all: credentials that stay would be taken for those of an addition that was interrupted.
    std::error_code error;
    const bool removed = std::filesystem::remove(folder.credentials(name), error);
    if (error) {
        return failure(program::kExitFailure,
                       "cannot remove " + folder.credentials(name).string() + ": " + error.message());
    }
    report.did("removed", who(*bus.find(name)));
    if (removed) report.did("removed", "its credentials", folder.credentials(name));
    std::erase_if(bus.users, [&name](const auto& one) { return one.name == name; });
    // A later board of that name is another one: users get it when they are added again.
    for (auto& user : bus.users)
        if (user.boards) user.boards->erase(name);
    bus.reads.erase(name);
    for (auto& [board, sources] : bus.reads)
        sources.erase(name);
    return {};
}

Outcome<void> refresh_credentials(const SecureFolder& folder, const SecuredBus& bus, SecureReport& report) {
    for (const auto& user : bus.users) {
        const auto read = program::read_credentials(folder.credentials(user.name));
        if (!read || read->user != user.name) continue;
        const auto written = write_credentials(folder, bus, user, read->password);
        if (!written) return tl::unexpected(written.error());
        if (*written)
            report.did("changed", "addresses in the credentials of " + who(user),
                       folder.credentials(user.name));
    }
    return {};
}

Outcome<void> write_users(const SecureFolder& folder, const SecuredBus& bus) {
    if (auto saved = folder.save(bus); !saved) return saved;
    const auto rules = folder.write(folder.rules(), rule_lines(bus), SecureFolder::Readers::kOwner);
    if (!rules) return tl::unexpected(rules.error());
    const auto passwords =
        folder.write(folder.passwords(), password_lines(bus), SecureFolder::Readers::kOwner);
    if (!passwords) return tl::unexpected(passwords.error());
    return {};
}

}  // namespace asip::cli
