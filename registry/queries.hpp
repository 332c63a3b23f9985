// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/model/model_set.hpp"
#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// Answers queries and requests to forget, without MQTT.
class Queries {
  public:
    using Request = std::variant<bus::Query, bus::Forget>;
    using Done = std::function<void(bus::Answer)>;

    struct Dependencies {
        Catalogue& catalogue;
        std::function<Instant()> now;
        /// Number of the last change event that was published.
        std::function<std::uint64_t()> seq;
        /// The events of boards that were forgotten by request.
        std::function<void(const std::vector<Event>&)> forgotten;
        /// A page of history, or a refusal; may call back later. Empty: none is kept.
        std::function<void(bus::Query, Done)> history;
        std::function<void(bus::Query, Done)> values{};  ///< the same of values
        model::ModelSet models{};
    };

    Queries(std::string registry, Dependencies dependencies);

    void set_epoch(std::string epoch) { epoch_ = std::move(epoch); }
    void set_settling(bool settling) { settling_ = settling; }

    /// Calls `done` once: within this call, except for history and values. `max_bytes` bounds a page (0: no
    /// limit); an item that alone is larger is given all the same.
    void answer(const Request& request, std::size_t max_bytes, const Done& done);
    /// `find`: kHistory or kValues.
    bool keeps(bus::Find find) const {
        return static_cast<bool>(find == bus::Find::kValues ? dependencies_.values : dependencies_.history);
    }
    bus::Answer refuse_kept(bus::Find find) const;
    /// `reason` a word for programs, `error` a sentence.
    bus::Answer refuse(std::string reason, std::string error) const;

  private:
    bus::Answer find(bus::Query query, std::size_t max_bytes);
    void kept(bus::Query query, std::size_t max_bytes, const Done& done);
    bus::Answer models(const bus::Query& query) const;
    bus::Answer forget(const bus::Forget& forget);
    bus::Answer complete(bus::Answer answer) const;

    std::string registry_;
    std::string epoch_;
    Dependencies dependencies_;
    bool settling_ = false;
};

}  // namespace asip::registry
