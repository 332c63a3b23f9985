// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/topics.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "asip/bus/request/demand.hpp"
#include "asip/bus/request/line_service.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/description.hpp"
#include "asip/model/names.hpp"

namespace asip::bus {
namespace {

constexpr std::size_t kMaxRootBytes = 128;
constexpr std::size_t kMaxDemanderBytes = 192;
constexpr std::string_view kDemand = "$demand/";

/// The part of `rest` before the next slash; `rest` becomes what is behind it, or ends (data() == nullptr).
std::string_view next_level(std::string_view& rest) {
    const auto slash = rest.find('/');
    const auto level = rest.substr(0, slash);
    rest = slash == std::string_view::npos ? std::string_view{} : rest.substr(slash + 1);
    return level;
}

/// USER/CLIENT
bool valid_demander(std::string_view text) {
    const auto slash = text.find('/');
    return slash != std::string_view::npos && slash > 0 && slash + 1 < text.size() &&
           text.find('/', slash + 1) == std::string_view::npos && text.size() <= kMaxDemanderBytes;
}

std::optional<TopicRef> parse_service_bus(std::string_view board, std::string_view rest, bool has_rest) {
    if (board == "$probe")
        return has_rest ? std::nullopt : std::optional(TopicRef{TopicKind::kProbe, {}, {}});
    if (!model::valid_board_name(board)) return std::nullopt;
    if (!has_rest) return TopicRef{TopicKind::kServiceNames, board, {}};
    if (rest == "$state") return TopicRef{TopicKind::kState, board, {}};
    if (rest == "$description") return TopicRef{TopicKind::kDescription, board, {}};
    if (rest == "$stats") return TopicRef{TopicKind::kStats, board, {}};
    if (rest == "$log") return TopicRef{TopicKind::kLog, board, {}};
    if (rest == "$commands") return TopicRef{TopicKind::kCommands, board, {}};
    if (rest == "$properties") return TopicRef{TopicKind::kProperties, board, {}};
    if (rest.starts_with(kDemand) && valid_demander(rest.substr(kDemand.size())))
        return TopicRef{TopicKind::kDemand, board, {}, rest.substr(kDemand.size())};
    return std::nullopt;
}

std::optional<TopicRef> parse_registry(std::string_view id, std::string_view rest, bool has_rest) {
    if (!has_rest)
        return id == "query" ? std::optional(TopicRef{TopicKind::kAnyRegistryQuery, {}, {}}) : std::nullopt;
    if (!model::valid_name(id)) return std::nullopt;
    if (rest == "$state") return TopicRef{TopicKind::kRegistryState, id, {}};
    if (rest == "$stats") return TopicRef{TopicKind::kRegistryStats, id, {}};
    if (rest == "events") return TopicRef{TopicKind::kRegistryEvents, id, {}};
    if (rest == "query") return TopicRef{TopicKind::kRegistryQuery, id, {}};
    return std::nullopt;
}

std::optional<TopicRef> parse_board(std::string_view board, std::string_view second, std::string_view rest,
                                    bool has_rest) {
    if (!model::valid_board_name(board)) return std::nullopt;
    if (!has_rest) {
        if (second == "out") return TopicRef{TopicKind::kBoardOut, board, {}};
        if (second == "in") return TopicRef{TopicKind::kBoardIn, board, {}};
        if (second == "$stop") return TopicRef{TopicKind::kStop, board, {}};
        if (second == "$values") return TopicRef{TopicKind::kValues, board, {}};
        if (second == "$links") return TopicRef{TopicKind::kLinks, board, {}};
        return std::nullopt;
    }
    if (second == "$link")
        return valid_demander(rest) ? std::optional(TopicRef{TopicKind::kLink, board, {}, rest})
                                    : std::nullopt;
    // No service has the name that stands for the line.
    if (!model::valid_name(second) && !(second == kLineService && rest == "out")) return std::nullopt;
    if (rest == "out") return TopicRef{TopicKind::kServiceOut, board, second};
    if (rest == "in") return TopicRef{TopicKind::kServiceIn, board, second};
    if (rest == "error") return TopicRef{TopicKind::kServiceError, board, second};
    if (rest == "set") return TopicRef{TopicKind::kServiceSet, board, second};
    return std::nullopt;
}

}  // namespace

Topics::Topics(std::string root) : root_(std::move(root)) {
    if (!valid_root(root_)) throw std::invalid_argument("not a topic root: \"" + root_ + "\"");
}

bool Topics::valid_root(std::string_view root) {
    if (root.empty() || root.size() > kMaxRootBytes || root.front() == '$') return false;
    const auto forbidden = [](unsigned char c) { return c < 0x20 || c >= 0x7f || c == '+' || c == '#'; };
    if (std::any_of(root.begin(), root.end(), forbidden)) return false;
    return root.front() != '/' && root.back() != '/' && root.find("//") == std::string_view::npos;
}

std::string Topics::join(std::string_view a, std::string_view b) const {
    std::string topic;
    topic.reserve(root_.size() + a.size() + b.size() + 2);
    return topic.append(root_).append("/").append(a).append("/").append(b);
}

std::string Topics::join(std::string_view a, std::string_view b, std::string_view c) const {
    std::string topic;
    topic.reserve(root_.size() + a.size() + b.size() + c.size() + 3);
    return topic.append(root_).append("/").append(a).append("/").append(b).append("/").append(c);
}

std::string Topics::demand(std::string_view board, std::string_view demander) const {
    return join("servicebus", board, kDemand).append(demander);
}

std::optional<TopicRef> Topics::parse(std::string_view topic) const {
    if (!topic.starts_with(root_) || topic.size() <= root_.size() || topic[root_.size()] != '/')
        return std::nullopt;
    auto rest = topic.substr(root_.size() + 1);
    const auto first = next_level(rest);
    const bool has_second = rest.data() != nullptr;
    if (!has_second)
        return first == "servicebus" ? std::optional(TopicRef{TopicKind::kBoardNames, {}, {}}) : std::nullopt;
    const auto second = next_level(rest);
    const bool has_third = rest.data() != nullptr;
    if (first == "servicebus") return parse_service_bus(second, rest, has_third);
    if (first == "registry") return parse_registry(second, rest, has_third);
    return parse_board(first, second, rest, has_third);
}

std::size_t Topics::longest_payload(std::string_view topic) const {
    constexpr auto kAny = std::numeric_limits<std::size_t>::max() - 1;
    const auto known = parse(topic);
    if (!known) return kAny;
    switch (known->kind) {
        case TopicKind::kBoardNames:
        case TopicKind::kServiceNames:
        case TopicKind::kState:
        case TopicKind::kProbe:
            return model::kMaxNameBytes;
        case TopicKind::kDemand:
            return kMaxDemandBytes;
        case TopicKind::kBoardIn:
        case TopicKind::kServiceIn:
        case TopicKind::kLink:
        case TopicKind::kStop:
        case TopicKind::kRegistryQuery:
        case TopicKind::kAnyRegistryQuery:
            return kMaxRequestBytes;
        case TopicKind::kDescription:
            return model::kMaxDescriptionBytes;
        default:
            return kAny;
    }
}

}  // namespace asip::bus
