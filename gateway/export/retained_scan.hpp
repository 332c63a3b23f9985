// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

#include "asip/mqtt/message.hpp"

namespace asip::gateway::exports {

/// What the broker retains of an export, read back: between begin() and take_all(). Pure.
class RetainedScan {
  public:
    static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

    void begin(std::string mark) {
        mark_ = std::move(mark);
        found_.clear();
        bytes_ = 0;
        complete_ = true;
    }
    bool runs() const { return !mark_.empty(); }
    const std::string& mark() const { return mark_; }
    /// One that was retained; others are passed over.
    void message(const mqtt::Message& message) {
        if (!runs() || !message.retain || message.payload.empty()) return;
        const auto bytes = message.topic.size() + message.payload.size() + 100;
        if (bytes_ + bytes > kMaxBytes) {
            complete_ = false;
            return;
        }
        if (found_.emplace(message.topic, message.payload).second) bytes_ += bytes;
    }
    /// False: there was more than is kept.
    bool complete() const { return complete_; }
    /// Topic -> payload. The scan is over.
    std::map<std::string, std::string> take_all() {
        mark_.clear();
        bytes_ = 0;
        return std::exchange(found_, {});
    }

  private:
    std::string mark_;
    std::map<std::string, std::string> found_;
    std::size_t bytes_ = 0;
    bool complete_ = true;
};

}  // namespace asip::gateway::exports
