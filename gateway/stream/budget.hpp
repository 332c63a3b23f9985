// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <string>

namespace asip::gateway {

/// Bytes that clients make the gateway keep, with one bound for each client: subscriptions and what waits in
/// them, unread answers, slow responses, waits, and remembered commands. Pure; one thread.
/// A client is the name of a token, or "address " and an address (see network_of()).
class Budget {
    struct Account {
        std::size_t bytes = 0;
        std::size_t max = 0;
    };

  public:
    explicit Budget(std::size_t max_bytes_per_client) : max_(max_bytes_per_client) {}

    /// What one thing of a client takes; given back by its end. May outlive the budget. One without a client
    /// is free.
    class Part {
      public:
        Part() = default;
        explicit Part(std::shared_ptr<Account> account) : account_(std::move(account)) {}
        Part(Part&& other) noexcept;
        Part& operator=(Part&& other) noexcept;
        ~Part() { set(0); }

        /// False: beyond its client's bound, and nothing changed. Less always succeeds.
        bool set(std::size_t bytes);
        bool add(std::size_t bytes) { return set(bytes_ + bytes); }
        /// No more than it takes.
        void give_back(std::size_t bytes) { set(bytes_ - bytes); }
        std::size_t bytes() const { return bytes_; }

      private:
        std::shared_ptr<Account> account_;
        std::size_t bytes_ = 0;
    };

    /// It takes nothing yet.
    Part part(const std::string& client);
    std::size_t bytes_of(const std::string& client) const;
    /// expire() forgets those that take nothing.
    std::size_t clients() const { return accounts_.size(); }
    void expire();

  private:
    std::size_t max_;
    std::map<std::string, std::weak_ptr<Account>> accounts_;
};

}  // namespace asip::gateway
