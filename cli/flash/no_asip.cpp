// SPDX-License-Identifier: Apache-2.0
#include "cli/flash/no_asip.hpp"

namespace asip::cli {
namespace {

bool never_answered(std::string_view state, std::string_view reason, std::string_view chip, bool offers) {
    return chip.empty() && !offers && state == "lost" &&
           reason == model::to_text(model::StateReason::kSilent);
}

}  // namespace

bool speaks_no_asip(const model::Description& board) {
    return board.link.kind == "serial" && board.firmware.chip.empty() && board.services.empty() &&
           board.state && board.state->state == model::BoardState::kLost &&
           board.state->reason == model::StateReason::kSilent;
}

bool speaks_no_asip(const bus::BoardItem& board) {
    return board.link.starts_with("serial ") &&
           never_answered(board.state, board.reason, board.chip, !board.services.empty());
}

bool speaks_no_asip(const bus::BriefBoard& board) {
    return never_answered(board.state, board.reason, board.chip, !board.services.empty());
}

// "pci-0000:00:14.0-usb-0:1.3:1.0-port0"
std::string port_text(std::string_view path) {
    const auto usb = path.rfind("-usb-");
    const auto begin = usb == path.npos ? usb : path.find(':', usb);
    const auto end = begin == path.npos ? begin : path.find(':', begin + 1);
    if (end == path.npos) return std::string(path);
    return "USB port " + std::string(path.substr(begin + 1, end - begin - 1));
}

}  // namespace asip::cli
