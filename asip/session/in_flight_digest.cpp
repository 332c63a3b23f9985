// SPDX-License-Identifier: Apache-2.0
// What the digest of a verified fence tells of the requests before it.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "asip/session/in_flight.hpp"

namespace asip::session {

/// Which requests the unclear errors of a batch belong to, so that the digest is the one that the board sent.
/// The errors came in the order of their requests.
class InFlight::Explanation {
  public:
    Explanation(const Batch& batch, std::int64_t digest) : batch_(batch), digest_(digest) { try_from(0, {}); }

    /// Nothing that the board can have done has this digest.
    bool is_none() const { return found_ == 0; }
    /// The item of each unclear error; nothing where more than one explanation fits.
    const std::vector<std::size_t>* owners() const { return found_ == 1 ? &owners_ : nullptr; }

  private:
    void try_from(std::size_t next, protocol::Digest digest) {
        if (next == batch_.items.size()) return compare(digest);
        const Item& item = batch_.items[next];
        const auto with = [&](int error) {
            auto more = digest;
            more.add(item.request.line, error);
            try_from(next + 1, more);
        };
        // An error that comes instead of a value is none of the request as such.
        if (item.error) with(item.error->first);
        if (!item.error || item.wants_value()) with(0);
        if (item.error || tried_.size() == batch_.unclear.size()) return;
        const Unclear& error = batch_.unclear[tried_.size()];
        if (std::find(error.candidates.begin(), error.candidates.end(), next) == error.candidates.end())
            return;
        tried_.push_back(next);
        with(error.code);
        if (item.wants_value()) with(0);
        tried_.pop_back();
    }

    void compare(protocol::Digest digest) {
        if (tried_.size() != batch_.unclear.size()) return;
        digest.add(batch_.fence.line);
        if (digest.value() != digest_) return;
        if (found_++ == 0) owners_ = tried_;
    }

    const Batch& batch_;
    const std::int64_t digest_;
    std::vector<std::size_t> tried_;
    std::vector<std::size_t> owners_;
    unsigned found_ = 0;
};

bool InFlight::settle_errors(Batch& batch, const protocol::Event& event) {
    if (!batch.fence.verifies) return true;
    const auto digest = fence_digest(event);
    if (!digest) return false;
    const Explanation explanation(batch, *digest);
    if (explanation.is_none()) return false;
    const auto* const owners = explanation.owners();
    if (owners == nullptr) return true;
    for (Item& item : batch.items)
        item.suspected = false;
    for (std::size_t i = 0; i < owners->size(); ++i) {
        Unclear& error = batch.unclear[i];
        batch.items[(*owners)[i]].error.emplace(error.code, std::move(error.text));
    }
    return true;
}

}  // namespace asip::session
