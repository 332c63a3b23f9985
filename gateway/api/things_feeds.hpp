// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "gateway/export/web_of_things.hpp"
#include "gateway/stream/feed.hpp"

namespace asip::gateway::api {

/// The values of one property of a PropertyFeed, each a message; the same value is sent once.
std::unique_ptr<Feed> property_values(std::unique_ptr<Feed> values, std::string id);

/// The changes of things in a feed of the catalogue: `thing_created`, `thing_updated`, `thing_deleted`.
/// `only`: one of these; empty: all.
std::unique_ptr<Feed> things_feed(std::unique_ptr<Feed> changes, exports::WebOfThings dialect,
                                  std::string only);

}  // namespace asip::gateway::api
