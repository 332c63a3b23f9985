// SPDX-License-Identifier: Apache-2.0
// The firmware's board against any bytes: it must survive them, keep to lines of its own, and answer a good
// request afterwards. The fake hardware aborts on any pin, channel or address that does not exist.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fake_board.hpp"

namespace {

class Probe : public asip::Service {
  public:
    Probe() : Service('X', 3) {}
    asip::FlashText name() const override { return F("Probe"); }
    void begin() override { asip::board.claimPin(7, *this); }
    asip::Error processRequest(asip::Request& request) override {
        if (request.tag() == 'T') {
            const auto number = request.signedNumber();
            const auto text = request.text();
            if (!request.complete()) return asip::Error::kBadArgument;
            asip::out.event('X', 'T');
            asip::out.signedNumber(number);
            asip::out.text(text);
            asip::out.end();
            return asip::Error::kNone;
        }
        return request.more() ? asip::Error::kDeviceNotAvailable : asip::Error::kInvalidDeviceNumber;
    }
    void reportValue(std::uint8_t index) override { asip::out.number(index); }
};

void check_lines(const std::string& sent) {
    std::size_t begin = 0;
    while (begin < sent.size()) {
        if (sent[begin] != '@' && sent[begin] != '~' && sent[begin] != '!') std::abort();
        const auto end = sent.find('\n', begin);
        if (end == std::string::npos) std::abort();
        begin = end + 1;
    }
}

std::string with_checksum(const std::string& line) {
    unsigned sum = 0;
    for (char c : line)
        sum ^= static_cast<unsigned char>(c);
    char end[8];
    std::snprintf(end, sizeof end, "*%02X\n", sum & 255);
    return line + end;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Probe probe;
    probe = Probe();
    asip::FakeBoard board({&probe});
    // Bytes of 0xFE and 0xFF are time and inputs, so that they come in between.
    std::string all;
    std::string bytes;
    int time_left = 12;  // enough for every timeout there is
    for (std::size_t i = 0; i < size; ++i) {
        if (data[i] < 0xFE) {
            bytes.push_back(static_cast<char>(data[i]));
            continue;
        }
        board.hardware().to_board += bytes;
        bytes.clear();
        all += board.run(3);
        if (data[i] == 0xFE) board.hardware().levels[2] = !board.hardware().levels[2];
        if (data[i] == 0xFF && time_left > 0) {
            --time_left;
            all += board.pass_time(100);
        }
    }
    all += board.send(bytes);
    check_lines(all);

    all = board.send("\n");
    all = asip::out.usesChecksum() ? board.send(with_checksum("#,E,fine")) : board.send("#,E,fine\n");
    check_lines(all);
    if (all.find("@#,E,fine") == std::string::npos) std::abort();
    return 0;
}
