// SPDX-License-Identifier: Apache-2.0
#include "NetworkLine.h"

namespace networkLine {

LineSink sink;

static constexpr uint16_t kRoom = 1024;
static uint8_t waiting[kRoom];
static uint16_t first, count;

static constexpr uint16_t kLongestLine = 1024;  // a map of seventy pins takes half of it
static char line[kLongestLine + 1];
static uint16_t length;

static void put(uint8_t byte) {
    waiting[(first + count) % kRoom] = byte;
    ++count;
}

bool give(const uint8_t* bytes, uint16_t size) {
    if (size > kRoom - count) return false;
    for (uint16_t i = 0; i < size; ++i)
        put(bytes[i]);
    return true;
}

bool giveLines(const uint8_t* text, uint16_t size) {
    if (size + 1 > kRoom - count) return false;
    give(text, size);
    if (size > 0 && text[size - 1] != '\n') put('\n');
    return true;
}

}  // namespace networkLine

namespace asip {
namespace line {

using namespace networkLine;

void begin() {}

int16_t read() {
    if (count == 0) return -1;
    const uint8_t byte = waiting[first];
    first = static_cast<uint16_t>((first + 1) % kRoom);
    --count;
    return byte;
}

uint8_t room() {
    return 255;
}

void write(uint8_t byte) {
    if (byte != '\n') {
        if (length < kLongestLine) networkLine::line[length++] = static_cast<char>(byte);
        return;
    }
    networkLine::line[length] = '\n';
    if (sink != nullptr) sink(networkLine::line, length);
    length = 0;
}

bool idle() {
    return true;
}
bool isRate(uint16_t) {
    return false;
}
void setRate(uint16_t) {}
bool usesPin(uint8_t) {
    return false;
}

}  // namespace line
}  // namespace asip
