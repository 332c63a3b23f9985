// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "gateway/export/exported_board.hpp"

namespace asip::gateway::exports {

/// Boards as things of the Web of Things: a Thing Description (TD 1.1) for each, with forms of HTTP. Values
/// are JSON, as those of Property. Pure.
class WebOfThings {
  public:
    /// For one asker.
    struct Forms {
        std::string base;    ///< "http://localhost:8080/"
        bool token = false;  ///< HTTP needs one
        bool may_set = true;
    };
    static constexpr std::string_view kBoardState = "board-state";

    /// `root`: of the bus' topics, a part of each id.
    explicit WebOfThings(std::string root = "asip") : root_(std::move(root)) {}

    /// An URN.
    std::string thing_id(std::string_view board) const;
    /// By an id, or by a name.
    std::string board_of(const std::string& id) const;
    nlohmann::json thing(const ExportedBoard& board, const Forms& forms) const;
    /// The thing that is the directory of the others.
    nlohmann::json directory(const Forms& forms) const;

  private:
    std::string root_;
};

}  // namespace asip::gateway::exports
