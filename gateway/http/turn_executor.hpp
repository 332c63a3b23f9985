// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/execution.hpp>
#include <boost/asio/execution_context.hpp>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "asip/bus/shares.hpp"

namespace asip::gateway::http {

/// An executor of Asio whose work runs as jobs of a name, in its turns.
class TurnExecutor {
  public:
    TurnExecutor(boost::asio::execution_context& context, bus::Shares& shares, std::string name)
        : state_(std::make_shared<State>(State{context, shares, std::move(name)})) {}

    template <class Function>
    void execute(Function&& function) const {
        // Jobs can be copied, and functions of Asio cannot.
        const auto held = std::make_shared<std::decay_t<Function>>(std::forward<Function>(function));
        state_->shares.add(state_->name, [held] {
            std::move (*held)();
            return false;
        });
    }
    boost::asio::execution_context& query(boost::asio::execution::context_t) const noexcept {
        return state_->context;
    }
    static constexpr boost::asio::execution::blocking_t query(boost::asio::execution::blocking_t) noexcept {
        return boost::asio::execution::blocking.never;
    }
    bool operator==(const TurnExecutor& other) const noexcept { return state_ == other.state_; }
    bool operator!=(const TurnExecutor& other) const noexcept { return state_ != other.state_; }

  private:
    struct State {
        boost::asio::execution_context& context;
        bus::Shares& shares;
        std::string name;
    };
    std::shared_ptr<State> state_;
};

}  // namespace asip::gateway::http
