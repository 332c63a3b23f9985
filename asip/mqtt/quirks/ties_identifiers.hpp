// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <utility>

namespace asip::mqtt {

/// A cluster that ties a client identifier to the node where it was first used: after that node died, it
/// refuses the identifier's subscriptions at the other nodes, or forgets them when the node is back, and the
/// client hears nothing any more. So where there are several brokers, each connection after the first one has
/// a new identifier. Identifiers are the name of the client with a secret behind it: a client that knows one
/// can end the connection. Pure.
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
    /// An accepted connection has ended.
    void connection_lost() {
        if (several_brokers_) current_ = name_ + "-" + secrets_();
    }
    /// The broker refused the identifier. Its rules may name those that a user may have.
    void refused() { current_ = first_; }

  private:
    std::string name_;
    bool several_brokers_;
    Secrets secrets_;
    std::string first_;
    std::string current_;
};

}  // namespace asip::mqtt
