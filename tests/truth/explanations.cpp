// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/explanations.hpp"

#include <algorithm>
#include <cstdint>

#include "asip/protocol/checksum.hpp"

namespace truth {

namespace {

class Explanations {
  public:
    explicit Explanations(const std::vector<ReadRequest>& batch) : batch_(batch) {
        asip::protocol::Digest digest;
        for (const ReadRequest& one : batch) {
            digest.add(one.line, std::max(one.error, 0));
            if (one.error >= 0) failed_.push_back(&one);
        }
        digest_ = digest.value();
        if (!failed_.empty()) try_from(0, 0, {});
    }

    unsigned found() const { return found_; }

  private:
    void try_from(std::size_t next, std::size_t placed, asip::protocol::Digest digest) {
        if (next == batch_.size()) {
            if (placed == failed_.size() && digest.value() == digest_) ++found_;
            return;
        }
        const std::string& line = batch_[next].line;
        auto without = digest;
        without.add(line);
        try_from(next + 1, placed, without);
        if (placed == failed_.size() || line.substr(0, 3) != failed_[placed]->line.substr(0, 3)) return;
        digest.add(line, failed_[placed]->error);
        try_from(next + 1, placed + 1, digest);
    }

    const std::vector<ReadRequest>& batch_;
    std::vector<const ReadRequest*> failed_;
    std::uint16_t digest_ = 0;
    unsigned found_ = 0;
};

}  // namespace

bool explained_twice(const std::vector<ReadRequest>& batch) {
    return Explanations(batch).found() > 1;
}

}  // namespace truth
