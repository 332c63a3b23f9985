// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <utility>

namespace asip::mqtt {

/// Clusters that tie a client identifier to its first node: after that node died they refuse the identifier's
/// subscriptions elsewhere, or forget them when it is back. So with several brokers each connection has a new
/// identifier: the client's name and a secret, since whoever knows one can end the connection. Pure.
class Identifier {
  public:
    using Secrets = std::function<std::string()>;

    Identifier(const std::string& name, bool several_brokers, Secrets secrets)
        : name_(name),
          several_brokers_(several_brokers),
          secrets_(std::move(secrets)),
          first_(name + "-" + secrets_()),
          current_(first_) {}

    const std::string& current() const { return current_; }
    void connection_lost() {
        if (several_brokers_) current_ = name_ + "-" + secrets_();
    }
    /// The broker's rules may name the identifiers of a user.
    void refused() { current_ = first_; }

  private:
    std::string name_;
    bool several_brokers_;
    Secrets secrets_;
    std::string first_;
    std::string current_;
};

}  // namespace asip::mqtt
