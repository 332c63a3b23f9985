// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

/// What `--format` takes: text with `{name}` places, `{{` and `}}` for braces, and `\n`, `\t`, `\\`.
class LineTemplate {
  public:
    /// Names may hold dots (`{data.distance}`). Fails on a brace that does not close and on an empty name.
    static Expected<LineTemplate> parse(std::string_view text);

    std::string fill(const std::function<std::string(std::string_view name)>& value_of) const;
    std::vector<std::string> names() const;

  private:
    struct Piece {
        bool is_name = false;
        std::string text;
    };
    std::vector<Piece> pieces_;
};

}  // namespace asip::cli
