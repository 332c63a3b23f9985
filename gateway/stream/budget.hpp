// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <string>

namespace asip::gateway {

/// What clients make the gateway keep, in bytes. Each client has one bound for all of it together:
/// subscriptions and what waits in them, answers that it does not read, responses that it takes slowly,
/// waits, and commands that are remembered. Pure; one thread.
///
/// A client is a text: the name of a token, or "address " and an address (see network_of()).
class Budget {
    struct Account {
        std::size_t bytes = 0;
        std::size_t max = 0;
    };

  public:
    explicit Budget(std::size_t max_bytes_per_client) : max_(max_bytes_per_client) {}

    /// What one thing of a client takes. It is given back when the part is destroyed; a part may outlive the
    /// budget. Move-only. One made without a client takes nothing from anybody, and everything fits.
    class Part {
      public:
        Part() = default;
        explicit Part(std::shared_ptr<Account> account) : account_(std::move(account)) {}
        Part(Part&& other) noexcept;
        Part& operator=(Part&& other) noexcept;
        ~Part() { set(0); }

        /// Takes so many bytes from now on. False: that is beyond the bound of its client, and nothing is
        /// changed. To take less always succeeds.
        bool set(std::size_t bytes);
        bool add(std::size_t bytes) { return set(bytes_ + bytes); }
        /// `bytes`: no more than it takes.
        void give_back(std::size_t bytes) { set(bytes_ - bytes); }
        std::size_t bytes() const { return bytes_; }

      private:
        std::shared_ptr<Account> account_;
        std::size_t bytes_ = 0;
    };

    /// A part of this client that takes nothing yet.
    Part part(const std::string& client);
    /// What a client takes now.
    std::size_t bytes_of(const std::string& client) const;
    /// Clients of which anything is known. Those that take nothing are forgotten by expire().
    std::size_t clients() const { return accounts_.size(); }
    void expire();

  private:
    std::size_t max_;
    std::map<std::string, std::weak_ptr<Account>> accounts_;
};

}  // namespace asip::gateway
