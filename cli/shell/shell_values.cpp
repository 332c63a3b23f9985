// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/shell_values.hpp"

#include <algorithm>

#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kMaxKinds = 8;
/// So that a report of many values leaves room for the others.
constexpr std::size_t kColumnsOfOne = 36;

}  // namespace

void ShellValues::services(std::vector<std::string> names) {
    order_ = std::move(names);
    std::erase_if(reports_, [this](const auto& one) {
        return std::find(order_.begin(), order_.end(), one.first) == order_.end();
    });
}

bool ShellValues::report(const std::string& service, const std::string& what, std::string text) {
    if (std::find(order_.begin(), order_.end(), service) == order_.end()) return false;
    auto& kinds = reports_[service];
    if (kinds.size() >= kMaxKinds && !kinds.contains(what)) return false;
    auto& kept = kinds[what];
    if (kept == text) return false;
    kept = std::move(text);
    return shown_ && wanted(service);
}

bool ShellValues::wanted(const std::string& service) const {
    return selected_.empty() || std::find(selected_.begin(), selected_.end(), service) != selected_.end();
}

std::string ShellValues::line(std::size_t columns) const {
    if (!shown_) return {};
    std::string result;
    for (const auto& service : order_) {
        const auto found = reports_.find(service);
        if (found == reports_.end() || !wanted(service)) continue;
        for (const auto& [what, text] : found->second) {
            if (!result.empty()) result += "   ";
            // `distance 42 cm` says already which service it is.
            const auto named = text.starts_with(service + " ") ? text : service + " " + text;
            result += fit(for_terminal(named), kColumnsOfOne);
        }
    }
    return fit(result, columns);
}

}  // namespace asip::cli
