// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "asip/bus/registry/items.hpp"
#include "asip/model/model_set.hpp"

namespace asip::gateway::api {

/// Which model describes a service of a board. Reading a description costs more than all else of a command:
/// it is read again only when the board has another one. Pure.
class BoardModels {
  public:
    static constexpr std::size_t kMaxBoards = 500;
    /// Beyond it, which the last board may exceed, all are read again.
    static constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
    /// JSON text of the board's description; empty: it has none.
    using Description = std::function<std::string()>;

    explicit BoardModels(const model::ModelSet& models, std::size_t max_bytes = kMaxBytes)
        : models_(models), max_bytes_(max_bytes) {}

    /// `description` is called only where the board's was not read yet. Null: none describes the service.
    model::ModelPtr find(const bus::BoardItem& board, std::string_view service,
                         const Description& description);
    /// How many bytes all that is kept takes, about.
    std::size_t bytes() const { return bytes_; }

  private:
    struct Entry {
        std::string session;
        std::uint64_t seq = 0;
        std::vector<bus::ServiceItem> services;
        std::map<std::string, model::ModelPtr, std::less<>> models;
        std::size_t bytes = 0;
    };
    const model::ModelSet& models_;
    const std::size_t max_bytes_;
    std::map<std::string, Entry, std::less<>> entries_;
    std::size_t bytes_ = 0;
};

/// Boards as JSON texts. Making one costs much more than sending it: of a board that is asked for again only
/// its age is written anew, as long as nothing else of it changes. Boards say how long their texts are:
/// beyond max_bytes, which the last one may exceed, all are made again. Pure.
class BoardTexts {
  public:
    static constexpr std::size_t kMaxBoards = 500;
    static constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

    explicit BoardTexts(std::size_t max_bytes = kMaxBytes) : max_bytes_(max_bytes) {}

    /// A JSON object: what bus::to_json() gives, in another order.
    std::string text(const bus::BoardItem& board);
    /// The bytes that are kept, about.
    std::size_t bytes() const { return bytes_; }

  private:
    struct Entry {
        bus::BoardItem board;
        std::string rest;  // the object behind its age
        std::size_t bytes = 0;
    };
    void make_room_for(const std::string& board);

    const std::size_t max_bytes_;
    std::map<std::string, Entry> entries_;
    std::size_t bytes_ = 0;
};

}  // namespace asip::gateway::api
