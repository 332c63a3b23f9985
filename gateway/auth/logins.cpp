// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/logins.hpp"

#include <algorithm>

namespace asip::gateway {
namespace {

constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kCookieBytes = 32;

template <class Entries>
void drop_old(Entries& entries, Time now) {
    std::erase_if(entries, [&](const auto& each) { return each.second.until <= now; });
}

template <class Entries>
std::size_t of_name(const Entries& entries, const std::string& name) {
    return static_cast<std::size_t>(std::count_if(
        entries.begin(), entries.end(), [&](const auto& each) { return each.second.rights.name == name; }));
}

}  // namespace

std::string Logins::make_code(const Rights& rights, Time now) {
    drop_old(codes_, now);
    if (of_name(codes_, rights.name) >= kMaxCodes) return {};
    auto code = secrets_(kCodeBytes);
    codes_[hash_of(code)] = {rights, now + kCodeTime};
    return code;
}

std::optional<Rights> Logins::offered(std::string_view code, Time now) const {
    const auto found = codes_.find(hash_of(code));
    if (found == codes_.end() || found->second.until <= now) return std::nullopt;
    return found->second.rights;
}

std::optional<std::string> Logins::redeem(std::string_view code, Time now) {
    const auto found = codes_.find(hash_of(code));
    if (found == codes_.end()) return std::nullopt;
    const Entry entry = std::move(found->second);
    codes_.erase(found);
    if (entry.until <= now) return std::nullopt;
    drop_old(sessions_, now);
    if (of_name(sessions_, entry.rights.name) >= kMaxSessions) end_oldest(entry.rights.name);
    auto cookie = secrets_(kCookieBytes);
    sessions_[hash_of(cookie)] = {entry.rights, now + kSessionTime};
    return cookie;
}

std::optional<Rights> Logins::session(std::string_view cookie, Time now) const {
    if (cookie.empty()) return std::nullopt;
    const auto found = sessions_.find(hash_of(cookie));
    if (found == sessions_.end() || found->second.until <= now) return std::nullopt;
    return found->second.rights;
}

void Logins::end_oldest(const std::string& name) {
    auto oldest = sessions_.end();
    for (auto each = sessions_.begin(); each != sessions_.end(); ++each) {
        if (each->second.rights.name != name) continue;
        if (oldest == sessions_.end() || each->second.until < oldest->second.until) oldest = each;
    }
    if (oldest != sessions_.end()) sessions_.erase(oldest);
}

void Logins::end(std::string_view cookie) {
    sessions_.erase(hash_of(cookie));
}

void Logins::end_unless(const std::function<bool(const Rights&)>& in_force) {
    const auto is_over = [&](const auto& each) { return !in_force(each.second.rights); };
    std::erase_if(codes_, is_over);
    std::erase_if(sessions_, is_over);
}

void Logins::expire(Time now) {
    drop_old(codes_, now);
    drop_old(sessions_, now);
}

}  // namespace asip::gateway
