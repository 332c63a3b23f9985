// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/firmware_board.hpp"

#include <fmt/format.h>

#include <boost/asio/post.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tests/cluster/commander.hpp"

namespace cluster {

namespace {

constexpr std::size_t kPixels = 18;
constexpr const char* kImage = ASIP_IMAGES "/asip_uno_pixels.elf";

// Black is what a pixel shows after a reset.
std::size_t color_of(std::size_t token) {
    return token + 1;
}

}  // namespace

FirmwareBoard::FirmwareBoard(boost::asio::io_context& io, const std::string& name, OnExecuted on_executed)
    : io_(io), on_executed_(std::move(on_executed)), colors_(kPixels) {
    const nlohmann::json strip{{"kind", "pixels"}, {"name", "strip"}, {"pin", 6}, {"count", kPixels}};
    const nlohmann::json board{{"name", name},
                               {"board", "uno"},
                               {"image", kImage},
                               {"link", folder_.file("port")},
                               {"parts", nlohmann::json::array({strip})}};
    simulator_ = std::make_unique<asip::test::ChildProcess>(std::vector<std::string>{
        ASIP_PROGRAMS "/asip-sim", folder_.write("board.json", board.dump()), "--no-socket", "--json"});
    simulator_->on_output([this](std::string_view line) { observe(line); });
    if (!simulator_->wait_for_output("link")) throw std::runtime_error("asip-sim: " + simulator_->errors());
}

FirmwareBoard::~FirmwareBoard() {
    simulator_->on_output({});
}

std::vector<std::string> FirmwareBoard::link() const {
    return {"--serial", folder_.file("port")};
}

// Two requests in one pass of the firmware's loop are shown at once: each has a pixel of its own.
std::string FirmwareBoard::request(std::size_t token) const {
    return fmt::format("P,P,1,{{{}:{}}}", token % kPixels, color_of(token));
}

void FirmwareBoard::cut() {
    simulator_->write_input("unplug\n");
}

void FirmwareBoard::plug() {
    simulator_->write_input("replug\n");
}

void FirmwareBoard::observe(std::string_view line) {
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (!event.is_object() || event.value("part", "") != "strip") return;
    std::istringstream shown(event.value("value", ""));
    std::string color;
    for (std::size_t pixel = 0; pixel < kPixels && shown >> color; ++pixel) {
        const auto now_shown = static_cast<std::uint32_t>(std::strtoul(color.c_str(), nullptr, 16));
        if (std::exchange(colors_[pixel], now_shown) == now_shown || now_shown == 0) continue;
        boost::asio::post(io_,
                          [this, token = now_shown - color_of(0), at = now()] { on_executed_(token, at); });
    }
}

}  // namespace cluster
