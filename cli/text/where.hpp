// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

/// A condition on a record, as `asipctl list --where` takes it:
///
///     chip=ATmega328P and (age > 1m or not services.name=servo) and sketch ~ 'Asip*'
///
/// Left of the sign stands a member of the record, or a path into it; a path leads into every element of an
/// array, and the condition holds where one of them does. Signs: `=`, `!=` (no element is equal), `<`, `<=`,
/// `>`, `>=`, `~` (a pattern with * and ?), `!~`. Without a sign: the member is there, and not empty, 0 or
/// false. Numbers are compared as numbers, `1m` with them as 60 seconds; everything else as text.
class Where {
  public:
    /// `fields`: members of the record. Fails with what is wrong, and the nearest member. At most 1,000
    /// characters.
    static Expected<Where> parse(std::string_view text, const std::vector<std::string>& fields);

    bool holds(const nlohmann::json& record) const;

    struct Node;

  private:
    explicit Where(std::shared_ptr<const Node> root) : root_(std::move(root)) {}

    std::shared_ptr<const Node> root_;
};

}  // namespace asip::cli
