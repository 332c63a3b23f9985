// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/property/documents.hpp"
#include "asip/time.hpp"

namespace asip::gateway {

/// The properties of boards and how they stand, as their agents publish them. Pure.
class Standing {
  public:
    using List = std::shared_ptr<const std::vector<property::Property>>;

    struct Counters {
        std::uint64_t damaged = 0;   ///< documents that cannot be read, or are of another version or board
        std::uint64_t outdated = 0;  ///< of an earlier session or moment
    };
    /// What a document changed.
    struct Change {
        bool list = false;
        bool anew = false;             ///< what the board reported before does not count any more
        std::vector<std::string> ids;  ///< of properties that stand otherwise now
        /// What was done with buttons, by the id of their property, in order; each once.
        std::vector<std::pair<std::string, property::ButtonAct>> acts;
        explicit operator bool() const { return list || !ids.empty() || !acts.empty(); }
    };
    /// `session`: of the board's description; empty: it is not known. An empty text: there is none any more.
    /// `stored`: the broker kept it; what was done with a button is of an earlier time.
    Change take_list(const std::string& board, std::string_view text, std::string_view session);
    Change take_values(const std::string& board, std::string_view text, std::string_view session, Time now,
                       bool stored = false);
    void forget(const std::string& board) { boards_.erase(board); }

    /// What the broker retains is read anew: what it does not have any more is gone once all was read.
    void reading();
    /// Returns the boards of which something is gone. Boards that are not `known` are forgotten.
    std::vector<std::string> complete(const std::function<bool(const std::string&)>& known);

    /// Null: none is known of this session.
    List list(std::string_view board, std::string_view session) const;
    /// Nothing: its agent does not say.
    std::optional<property::ShownValue> value(std::string_view board, std::string_view session,
                                              std::string_view id, Time now) const;
    std::size_t size() const { return boards_.size(); }
    const Counters& counters() const { return counters_; }

    /// Calls back for each change until what is returned ends.
    using Listener = std::function<void(const std::string& board, const Change& change)>;
    std::shared_ptr<void> listen(Listener listener);
    void tell(const std::string& board, const Change& change) const;

  private:
    template <class Document>
    struct Kept {
        property::DocumentHead head;
        Document document{};
        Time at{};
        bool seen = true;  // since the broker is read anew
        bool there() const { return !head.session.empty(); }
    };
    struct Board {
        Kept<List> list;
        Kept<decltype(property::ValueDocument::values)> values;
        std::uint64_t restarts = 0;  // of the board, by that document
        // What was done last with a button, also once its document is gone: it is not told again.
        std::string session_of_act;
        std::uint64_t last_act = 0;  // its number
    };
    bool may_replace(const property::DocumentHead& old, const property::DocumentHead& head,
                     const std::string& board, std::string_view session);

    std::map<std::string, Board, std::less<>> boards_;
    std::shared_ptr<std::list<Listener>> listeners_ = std::make_shared<std::list<Listener>>();
    Counters counters_;
};

}  // namespace asip::gateway
