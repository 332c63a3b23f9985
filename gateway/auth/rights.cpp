// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/rights.hpp"

#include <algorithm>
#include <array>

#include "asip/bus/pattern.hpp"
#include "asip/link/cable_frames.hpp"
#include "asip/text/nearest.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {
namespace {

bool any_matches(const std::vector<std::string>& patterns, std::string_view text) {
    return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&](const std::string& each) {
               return bus::matches_pattern(each, text);
           });
}

constexpr std::array<std::string_view, 5> kRoles{"none", "kiosk", "viewer", "operator", "admin"};

}  // namespace

std::string_view to_string(Role role) {
    return kRoles[static_cast<std::size_t>(role)];
}

bool Rights::sees_board(std::string_view board) const {
    return dashboard.empty() && any_matches(boards, board);
}

bool Rights::may_lend() const {
    if (!place.empty()) return true;
    const std::string all_lent = std::string(link::kLentPrefix) + "*";
    return may_label() && dashboard.empty() &&
           (boards.empty() || std::any_of(boards.begin(), boards.end(), [&](const std::string& each) {
                return each == "*" || each == all_lent;
            }));
}

bool Rights::sees_service(std::string_view board, std::string_view service) const {
    return sees_board(board) && any_matches(services, service);
}

std::string Rights::seen() const {
    if (!limited()) return {};
    std::string text = dashboard;
    for (const auto* patterns : {&boards, &services}) {
        for (const auto& each : *patterns)
            text.append(each).append(",");
        text += "/";
    }
    return text;
}

std::string Rights::mark() const {
    constexpr std::size_t kDigits = 16;
    return token_hash.empty() ? std::string() : hash_of(token_hash).substr(0, kDigits);
}

Expected<Rights> parse_role(std::string_view text) {
    constexpr std::array<std::string_view, 5> kWords{"kiosk", "viewer", "operator", "operator+raw", "admin"};
    Rights rights;
    for (std::size_t i = 1; i < kRoles.size(); ++i)
        if (text == kRoles[i]) rights.role = static_cast<Role>(i);
    if (text == "operator+raw") rights.role = Role::kOperator, rights.raw = true;
    if (rights.role == Role::kNone) {
        return fail("\"" + std::string(text) +
                    "\" is not a role; there are kiosk, viewer, operator, operator+raw "
                    "and admin" +
                    text::did_you_mean(text, kWords));
    }
    return rights;
}

}  // namespace asip::gateway
