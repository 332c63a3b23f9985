// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <deque>
#include <map>
#include <string>
#include <string_view>

#include "asip/protocol/checksum.hpp"
#include "asip/session/action.hpp"
#include "asip/time.hpp"
#include "tests/fuzz/require.hpp"

/// Requests of which each has a number of its own, so that a line on the wire says which one it is, and what
/// must be true of them whatever the board says.
class Marks {
  public:
    /// The line of the next one: `W,w,NUMBER`, with what of `more` may be in a request.
    std::string next(std::string_view more) const {
        std::string line = "W,w," + std::to_string(next_);
        for (const char c : more.substr(0, 40))
            if (c > ' ' && c < 127)
                line += line.find(',', 4) == line.npos ? std::string{',', c} : std::string{c};
        return line;
    }
    void refused() { ++next_; }
    void accepted(asip::session::RequestId id, std::string line, asip::Time deadline) {
        ++next_;
        open_[id] = {std::move(line), deadline};
    }

    /// A line goes to the board.
    void wrote(std::string_view written, asip::Time now) {
        const auto checked = asip::protocol::verify_checksum(written);
        std::string_view line = checked ? *checked : written;
        while (!checked && line.ends_with(' '))
            line.remove_suffix(1);
        if (line.empty()) return;
        digest_.add(line);
        if (line.starts_with("W,w,")) return sent(line, now);
        if (line[0] != '#' && !line.starts_with("I,")) return;
        std::string proof = "@" + std::string(line.substr(0, 3));
        if (line.starts_with("#,E,") || line.starts_with("#,V,")) proof += line.substr(3);
        if (line.starts_with("#,V,")) proof += ',' + std::to_string(std::exchange(digest_, {}).value());
        fences_.push_back({std::move(proof), ++written_, heard_.rfind('\n') + 1});
    }
    void heard(std::string_view bytes) { heard_ += bytes; }
    /// The session found out that something on the line was lost or damaged, or lost the link.
    void doubt() { doubted_ = ++written_; }

    void ended(const asip::session::Finished& end) {
        using asip::session::Ending;
        const auto known = open_.find(end.id);
        if (known == open_.end()) return;
        const Mark mark = known->second;
        open_.erase(known);
        REQUIRE((mark.sent == 0) == (end.ending == Ending::kNotSent));
        if (end.ending != Ending::kExecuted && end.ending != Ending::kUnproven) return;
        REQUIRE(mark.sent > doubted_);
        REQUIRE(std::any_of(fences_.begin(), fences_.end(), [&](const Fence& fence) {
            return fence.written > mark.sent && heard_.find(fence.proof, fence.heard) != heard_.npos;
        }));
    }

  private:
    struct Mark {
        std::string line;
        asip::Time deadline;
        std::size_t sent = 0;  // as written_, 0: not yet
    };
    struct Fence {
        std::string proof;  // what an answer to it contains
        std::size_t written;
        std::size_t heard;  // the line that was under way when it was written, and what follows
    };

    void sent(std::string_view line, asip::Time now) {
        const auto found = std::find_if(open_.begin(), open_.end(),
                                        [&](const auto& entry) { return entry.second.line == line; });
        REQUIRE(found != open_.end());  // accepted, and not ended
        REQUIRE(found->second.sent == 0);
        REQUIRE(now < found->second.deadline);
        found->second.sent = ++written_;
    }

    unsigned next_ = 1;
    std::map<asip::session::RequestId, Mark> open_;
    std::deque<Fence> fences_;
    std::string heard_;
    asip::protocol::Digest digest_;
    std::size_t written_ = 0;
    std::size_t doubted_ = 0;
};
