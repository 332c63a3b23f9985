// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace truth {

/// What of each client waits to be sent, and whether the clients are served in turn: between two requests of
/// one, each other client that waits is served once.
class Turns {
  public:
    void waits(unsigned client, std::size_t command) { waiting_[client].insert(command); }
    void gone(unsigned client, std::size_t command);
    void all_gone();
    /// One of several that look alike went: from now on it is not known whose turn it is.
    void give_up() { known_ = false; }
    /// Whose turn it was not, and why.
    std::optional<std::string> sent(unsigned client, std::size_t command);

  private:
    std::map<unsigned, std::set<std::size_t>> waiting_;  // none of them empty
    std::map<unsigned, std::set<unsigned>> passed_;      // of a client that waits: those served meanwhile
    bool known_ = true;
};

}  // namespace truth
