// SPDX-License-Identifier: Apache-2.0
#include "asip/link/boot_loader.hpp"

#include <algorithm>
#include <array>

#include "asip/text/printable.hpp"

namespace asip::link {
namespace {

constexpr std::array kBootLoaders{
    BootLoader{"uno", "uno", "ATmega328P", "m328p", "arduino", "115200"},
    BootLoader{"nano", "uno", "ATmega328P", "m328p", "arduino", "115200"},
    BootLoader{"nano-old", "uno", "ATmega328P", "m328p", "arduino", "57600"},
    BootLoader{"mega", "mega", "ATmega2560", "m2560", "wiring", "115200"},
    BootLoader{"", "", "ATmega168", "m168", "arduino", "19200"},
    BootLoader{"", "", "ATmega1280", "m1280", "arduino", "57600"},
};
constexpr std::array<std::string_view, 4> kUno{"0001", "0043", "0243", "006a"};
constexpr std::array<std::string_view, 6> kMega{"0010", "0042", "0044", "003f", "0210", "0242"};
constexpr std::size_t kMaxLineBytes = 1024;
constexpr int kMarks = 50;  // of a whole progress bar

bool has(std::string_view text, std::string_view part) {
    return text.find(part) != text.npos;
}

template <class List>
bool contains(const List& list, std::string_view text) {
    return std::find(list.begin(), list.end(), text) != list.end();
}

}  // namespace

std::optional<BootLoader> boot_loader_of_chip(std::string_view chip) {
    const auto found = std::find_if(kBootLoaders.begin(), kBootLoaders.end(),
                                    [chip](const BootLoader& loader) { return loader.chip == chip; });
    return found == kBootLoaders.end() ? std::nullopt : std::optional(*found);
}

Expected<std::vector<BootLoader>> boot_loaders(std::string_view board, std::string_view vendor,
                                               std::string_view product) {
    const auto &uno = kBootLoaders[0], &nano = kBootLoaders[1], &nano_old = kBootLoaders[2],
               &mega = kBootLoaders[3];
    for (const auto& loader : kBootLoaders)
        if (!board.empty() && loader.board == board) return std::vector{loader};
    if (!board.empty())
        return fail("\"" + text::printable(board) + "\" is none of uno, nano, nano-old, mega");
    const bool arduino = vendor == "2341" || vendor == "2a03";
    if (arduino && contains(kUno, product)) return std::vector{uno};
    if (arduino && contains(kMega, product)) return std::vector{mega};
    const bool other_way = arduino || vendor == "239a" || vendor == "1b4f" || vendor == "16c0" ||
                           vendor == "2e8a" || vendor == "303a" || vendor == "2886";
    if (other_way)
        return fail("boards of this kind (USB " + std::string(vendor) + ":" + std::string(product) +
                    ") take firmware in a way of their own: load AsipServices by the Arduino IDE. Where it "
                    "is an Uno, a Nano or a Mega, say which: --board uno|nano|nano-old|mega");
    return std::vector{nano, nano_old, mega};
}

std::vector<std::string> avrdude_call(const BootLoader& loader, const std::string& avrdude,
                                      const std::string& port, const std::string& image, char format) {
    // -D: boot loaders cannot erase the chip, and need not.
    std::vector<std::string> call{
        avrdude, "-D", "-p", std::string(loader.part), "-c", std::string(loader.method),
        "-P",    port, "-b", std::string(loader.baud), "-U", "flash:w:" + image + ":" + format};
    // Another one may be there. Ten attempts, as it makes by itself, take a minute.
    if (loader.method == "arduino") call.insert(call.end(), {"-x", "attempts=3"});
    return call;
}

void AvrdudeOutput::take(std::string_view bytes) {
    for (const char c : bytes) {
        if (c == '\n' || c == '\r') {
            end_line();
            continue;
        }
        if (line_.size() < kMaxLineBytes) line_ += c;
        const bool writing = line_.starts_with("Writing |");
        if (!writing && !(started_ && line_.starts_with("Reading |"))) continue;
        started_ = true;
        verifies_ = !writing;
        percent_ = static_cast<int>(
            std::min<std::ptrdiff_t>(100, std::count(line_.begin(), line_.end(), '#') * 100 / kMarks));
    }
}

void AvrdudeOutput::end_line() {
    if (has(line_, "not in sync") || has(line_, "not responding") || has(line_, "timeout communicating") ||
        has(line_, "getsync(): timeout") || has(line_, "getsync(): can't"))
        no_answer_ = true;
    if (has(line_, "xpected signature") || has(line_, "ouble check chip") ||
        has(line_, "nvalid device signature"))
        wrong_chip_ = true;
    if (has(line_, "resource busy")) busy_ = true;
    if (has(line_, "ermission denied")) denied_ = true;
    if (has(line_, "verification error") || has(line_, "verification mismatch") ||
        has(line_, "content mismatch"))
        differs_ = true;
    if (line_.find_first_not_of(' ') != line_.npos && !has(line_, "|") && !has(line_, "done.")) last_ = line_;
    line_.clear();
}

std::string_view AvrdudeOutput::step() const {
    return !started_ ? "connecting" : verifies_ ? "verifying" : "writing";
}

std::string AvrdudeOutput::failure(int status, std::string_view port, const std::string& avrdude) const {
    const std::string at(port);
    if (status == 127)
        return avrdude +
               " is not installed on the machine of the board. Type there: sudo apt install avrdude";
    if (busy_) return at + " is in use by another program; end that (fuser " + at + ") and try again";
    if (denied_)
        return "no right on " + at + "; type: sudo usermod -aG dialout USER, with the user of the agent";
    if (wrong_chip_)
        return "another chip than expected is on the board: say which board it is, --board "
               "uno|nano|nano-old|mega";
    if (differs_)
        return "what was written does not read back the same: try again, with another cable or USB port";
    if (started_) return "the board fell silent while it was written: plug it in again, and try again";
    if (no_answer_)
        return "no boot loader answers: press the board's reset button and try again, try another cable "
               "(some have no data lines), or say which board it is, --board uno|nano|nano-old|mega";
    return avrdude + " ended with status " + std::to_string(status) +
           (last_.empty() ? std::string() : ": " + text::printable(last_));
}

}  // namespace asip::link
