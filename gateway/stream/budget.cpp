// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/budget.hpp"

#include <utility>

namespace asip::gateway {

Budget::Part::Part(Part&& other) noexcept
    : account_(std::move(other.account_)), bytes_(std::exchange(other.bytes_, 0)) {}

Budget::Part& Budget::Part::operator=(Part&& other) noexcept {
    if (this == &other) return *this;
    set(0);
    account_ = std::move(other.account_);
    bytes_ = std::exchange(other.bytes_, 0);
    return *this;
}

bool Budget::Part::set(std::size_t bytes) {
    if (account_ != nullptr) {
        const std::size_t others = account_->bytes - bytes_;
        if (bytes > bytes_ && (others >= account_->max || bytes > account_->max - others)) return false;
        account_->bytes = others + bytes;
    }
    bytes_ = bytes;
    return true;
}

Budget::Part Budget::part(const std::string& client) {
    auto& known = accounts_[client];
    auto account = known.lock();
    if (account == nullptr) {
        account = std::make_shared<Account>(Account{0, max_});
        known = account;
    }
    return Part(std::move(account));
}

std::size_t Budget::bytes_of(const std::string& client) const {
    const auto found = accounts_.find(client);
    const auto account = found == accounts_.end() ? nullptr : found->second.lock();
    return account == nullptr ? 0 : account->bytes;
}

void Budget::expire() {
    std::erase_if(accounts_, [](const auto& each) { return each.second.expired(); });
}

}  // namespace asip::gateway
