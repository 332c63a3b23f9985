// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "asip/catalogue/name_order.hpp"
#include "asip/model/board_state.hpp"

namespace asip::catalogue {

inline constexpr std::size_t kStates = 5;
constexpr std::size_t index_of(model::BoardState state) {
    return static_cast<std::size_t>(state);
}

/// A kind of service: the index of the boards that have it, by state.
struct Kind {
    std::string name;
    std::vector<std::string> units;  // of the standard model
    std::array<BoardSet, kStates> boards;
    std::array<std::size_t, kStates> services{};  // a board may have several of one kind
    std::uint32_t references = 0;                 // service lists that mention it
    bool dirty = false;                           // some of `boards` has changes that wait
};

using UnitsOf = std::function<std::vector<std::string>(std::string_view model)>;

/// All kinds in use. A kind that no service list mentions any more is dropped, if it is dirty when it is
/// settled.
class KindTable {
  public:
    explicit KindTable(UnitsOf units_of) : units_of_(std::move(units_of)) {}

    /// Adds a reference; makes the kind if it is new. `model` ("distance@1") gives its units; may be empty.
    Kind* refer(std::string_view name, std::string_view model);
    void release(Kind* kind);
    void mark_dirty(Kind* kind);
    void settle(const NameOrder& order);
    bool settled() const { return dirty_.empty(); }
    Kind* find(std::string_view name) const;
    const std::unordered_map<std::string, std::unique_ptr<Kind>>& all() const { return kinds_; }

  private:
    UnitsOf units_of_;
    std::unordered_map<std::string, std::unique_ptr<Kind>> kinds_;
    std::vector<Kind*> dirty_;
};

}  // namespace asip::catalogue
