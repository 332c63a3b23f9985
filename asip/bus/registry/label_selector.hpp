// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::bus {

/// Chooses boards by labels: `room=lab,floor!=2,camera,!old`. All terms must hold; `KEY!=VALUE` and `!KEY`
/// hold without such a label.
class LabelSelector {
  public:
    static constexpr std::size_t kMaxBytes = 1024;
    static constexpr std::size_t kMaxTerms = 32;

    /// Holds for every board.
    LabelSelector() = default;
    /// Values with a comma, or a blank at an end, stand in quotes: `owner="Smith, Ann"`. Fails with what to
    /// write; an empty text, too, since it would choose every board.
    static Expected<LabelSelector> parse(std::string_view text);

    bool empty() const { return terms_.empty(); }
    bool matches(const std::map<std::string, std::string>& labels) const;
    /// Empty: every board.
    std::string text() const;
    friend bool operator==(const LabelSelector&, const LabelSelector&) = default;

  private:
    struct Term {
        enum class Kind { kIs, kIsNot, kHas, kHasNot };
        Kind kind = Kind::kHas;
        std::string key;
        std::string value{};
        friend bool operator==(const Term&, const Term&) = default;
    };
    static Expected<Term> parse_term(std::string_view text);

    std::vector<Term> terms_;
};

}  // namespace asip::bus
