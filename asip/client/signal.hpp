// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "asip/client/stream.hpp"

namespace asip::client {

/// Callbacks, called in the order of their registration. Callbacks may register others and drop any,
/// themselves too.
template <class... Args>
class Signal {
  public:
    using Callback = std::function<void(Args...)>;

    /// Calls `callback` at each emit() until the returned subscription is destroyed or reset.
    Subscription connect(Callback callback) {
        auto registration = std::make_shared<Callback>(std::move(callback));
        registered_.push_back(registration);
        return Subscription(registration);
    }

    /// Calls every callback that is registered now.
    void emit(Args... args) {
        // By index: a callback may register another, which moves the vector. New ones wait for the next emit.
        const std::size_t count = registered_.size();
        ++depth_;
        for (std::size_t i = 0; i < count; ++i)
            if (const auto callback = registered_[i].lock()) (*callback)(args...);
        // Erasing inside a nested emit would shift what the outer one is about to call.
        if (--depth_ == 0) std::erase_if(registered_, [](const auto& each) { return each.expired(); });
    }

  private:
    std::vector<std::weak_ptr<Callback>> registered_;
    int depth_ = 0;
};

}  // namespace asip::client
