#pragma once
#include <functional>
#include <optional>
#include <string>

#include "asip/bus/answer.hpp"
#include "asip/bus/query.hpp"
#include "asip/mqtt/message.hpp"
#include "registry/catalogue/catalogue.hpp"

namespace asip::registry {

/// Answers what arrives on the query topics.
class QueryService {
  public:
    struct Dependencies {
        Catalogue& catalogue;
        std::function<Instant()> now;
        /// Board forgotten by request: its events, to be told and tidied up after.
        std::function<void(const std::vector<Event>&)> forgotten;
        /// One page of history; empty function: none is kept.
        std::function<Expected<bus::Answer>(const bus::Query&)> history;
    };

    QueryService(std::string registry, Dependencies dependencies);

    /// Written into each answer.
    void set_epoch(std::string epoch) { epoch_ = std::move(epoch); }
    void set_settling(bool settling) { settling_ = settling; }
    /// The broker's limit; 0: none.
    void set_max_bytes(std::size_t bytes) { max_bytes_ = bytes; }

    /// The message to publish as answer; nothing where the request says no place for one.
    std::optional<mqtt::Message> answer(const mqtt::Message& request);

  private:
    bus::Answer answer_to(const nlohmann::json& object);
    bus::Answer find(bus::Query query);
    bus::Answer forget(const bus::Forget& forget);
    static bus::Answer refused(std::string reason, std::string error);

    std::string registry_;
    std::string epoch_;
    Dependencies dependencies_;
    bool settling_ = false;
    std::size_t max_bytes_ = 0;
};

}  // namespace asip::registry
