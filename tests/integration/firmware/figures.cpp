// SPDX-License-Identifier: Apache-2.0
#include "figures.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>

#include "firmware_board.hpp"
#include "quadrature.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

constexpr const char* kImage = "asip_uno";
constexpr double kCyclesPerMs = 16000;

struct Size {
    long text, data, bss;
};

Size size_of_image(const std::string& image = kImage) {
    const std::string command = "avr-size " + std::string(ASIP_IMAGES) + "/" + image + ".elf";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::array<char, 256> line{};
    Size size{};
    if (!pipe || !std::fgets(line.data(), line.size(), pipe.get()) ||
        !std::fgets(line.data(), line.size(), pipe.get()) ||
        std::sscanf(line.data(), "%ld %ld %ld", &size.text, &size.data, &size.bss) != 3) {
        throw std::runtime_error("avr-size says nothing of use");
    }
    return size;
}

double max_stack() {
    FirmwareBoard board(kImage);
    board->watch_stack();
    for (const char* line : {"#,?",         "#,N",       "#,S",
                             "#,X",         "#,I",       "#,I,a-name-of-32-characters-is-longest",
                             "#,I,uno-1",   "#,I",       "#,V,12345678",
                             "#,V,-",       "I,M",       "I,m",
                             "I,p",         "I,c",       "I,P,13,3",
                             "I,P,2,2",     "I,P,3,5",   "I,P,2,9",
                             "I,d,13,1",    "I,d,13",    "I,d,99,1",
                             "I,a,3,255",   "I,a,3,256", "I,a,2,1",
                             "I,A,5",       "I,A,70000", "Z,x",
                             "I",           "#",         "#,B,1",
                             "#,B,500000",  "I,A,0",     "#,C,1",
                             "I,d,13,0*5E", "#,R"}) {
        board->send(std::string(line) + "\n");
        board->run_for(milliseconds(150));
    }
    return board->max_stack();
}

struct RoundTrip {
    double cycles;  // from the request's first start bit to the event's last stop bit
    double wire;    // what its bytes take
};

/// Pin 13 wired to pin 2. The mean of requests that find the firmware's loop and clock at every phase.
RoundTrip round_trip(unsigned baud) {
    constexpr int kTrips = 400;
    FirmwareBoard board(kImage, "uno", {{"wire", {{"from", 13}, {"to", 2}}, "wire"}});
    board.ask("I,P,13,3");
    board.ask("I,P,2,1");
    if (baud != 57600) board.step_up(baud);
    double total = 0;
    std::size_t bytes = 0;
    for (int trip = 0; trip < kTrips; ++trip) {
        board->run_for(std::chrono::nanoseconds(2'000'000 + 40'130 * trip));
        const auto begin = board->cycles();
        const std::string request = trip % 2 == 0 ? "I,d,13,1\n" : "I,d,13,0\n";
        board->send(request);
        const auto event = board->read_line(milliseconds(10));
        if (!event || event->text != (trip % 2 == 0 ? "@I,d,4,4" : "@I,d,4,0"))
            throw std::runtime_error("no event");
        total += static_cast<double>(event->cycle - begin);
        bytes = request.size() + event->text.size() + 1;
    }
    return {total / kTrips, static_cast<double>(bytes) * 10 * 16e6 / board->board_baud()};
}

bool follows(unsigned hertz, unsigned baud) {
    FirmwareBoard board(kImage);
    if (baud != 57600) board.step_up(baud);
    const double half_ns = 5e8 / hertz;
    const int edges = static_cast<int>(hertz);  // half a second of them
    const auto begin = board->now();
    for (int edge = 1; edge <= edges; ++edge) {
        board->drive(2, edge % 2 == 1 ? sim::Level::kHigh : sim::Level::kLow);
        const auto next = begin + std::chrono::nanoseconds(static_cast<long long>(half_ns * edge));
        if (next > board->now()) board->run_for(next - board->now());
    }
    int events = 0;
    for (const auto& line : board.lines_within(milliseconds(50))) {
        if (line != (events % 2 == 0 ? "@I,d,4,4" : "@I,d,4,0")) return false;
        ++events;
    }
    return events == edges;
}

// An event of nine bytes for each edge: more does not fit the line.
double fastest_square_wave(unsigned baud) {
    const unsigned limit = baud / 10 / 9 / 2;
    unsigned best = 0;
    for (unsigned hertz = 1000; hertz <= limit && follows(hertz, baud);
         hertz += hertz < limit * 9 / 10 ? 100 : 10)
        best = hertz;
    return best;
}

// AsipMirto at 500,000 baud with everything that it has reported each 25 ms.
constexpr const char* kMirtoReports[] = {"E,A,25", "B,A,25", "R,A,25", "D,A,25", "I,A,25"};

std::unique_ptr<FirmwareBoard> reporting_mirto() {
    auto board = std::make_unique<FirmwareBoard>(
        "asip_uno_mirto", "uno",
        std::vector<sim::PartConfig>{{"ultrasonic", {{"pin", 19}, {"distance", 42}}, "sonar"}});
    board->step_up(500000);
    for (const char* request : kMirtoReports)
        board->ask(request);
    return board;
}

double lost_steps() {
    const auto board = reporting_mirto();
    Quadrature wheels(*board, {{3, 7}, {2, 4, true}});
    long left = 0, right = 0;
    const auto add = [&](milliseconds time) {
        for (const auto& line : board->lines_within(time)) {
            long first = 0, second = 0;
            if (std::sscanf(line.c_str(), "@E,e,2,{%*d:%ld,%*d:%ld}", &first, &second) != 2) continue;
            left += first;
            right += second;
        }
    };
    for (int part = 0; part < 100; ++part) {
        for (int i = 0; i < 15; ++i)
            (*board)->send("Z,x\n");
        wheels.turn(40, std::chrono::microseconds(250));
        add(milliseconds(1));
    }
    add(milliseconds(100));
    return static_cast<double>(std::labs(8000 - left) + std::labs(8000 - right));
}

double latest_report() {
    const auto board = reporting_mirto();
    std::map<char, std::vector<double>> times;
    const auto end = (*board)->now() + std::chrono::seconds(2);
    while ((*board)->now() < end) {
        const auto line = (*board)->read_line(milliseconds(100));
        if (!line) throw std::runtime_error("no report");
        times[line->text[1]].push_back(static_cast<double>(line->cycle) / kCyclesPerMs);
    }
    double latest = 0;
    for (auto& [service, at] : times) {
        if (at.size() < 78) throw std::runtime_error(std::string("too few reports of ") + service);
        for (std::size_t i = 0; i < at.size(); ++i)
            at[i] -= 25.0 * static_cast<double>(i);
        std::sort(at.begin(), at.end());
        const double usual = at[at.size() / 2];
        latest = std::max({latest, usual - at.front(), at.back() - usual});
    }
    if (times.size() != 4) throw std::runtime_error("not every service reports");
    return latest;
}

}  // namespace

std::vector<Figure> measure_figures() {
    const auto size = size_of_image();
    const auto robot = size_of_image("asip_uno_mirto");
    const auto displays = size_of_image("asip_uno_displays");
    const auto climate = size_of_image("asip_uno_climate");
    const auto thermometers = size_of_image("asip_uno_thermometers");
    const auto one_wire = size_of_image("asip_uno_onewire");
    const auto chips = size_of_image("asip_uno_i2c");
    const auto weather = size_of_image("asip_uno_weather");
    const auto steppers = size_of_image("asip_uno_steppers");
    const auto room = size_of_image("asip_uno_room");
    const auto slow = round_trip(57600);
    const auto fast = round_trip(500000);
    const auto fastest = round_trip(1000000);
    return {
        {"static RAM", "B", static_cast<double>(size.data + size.bss), 280, 278},
        // Among them, requests without a line end take 270, the levels of all inputs 42, and each terminal's
        // line end, with what 0.4 skips before a request, 26.
        {"flash", "B", static_cast<double>(size.text + size.data), 6600, 6570},
        {"deepest stack under every request", "B", max_stack(), 80, 40},
        {"AsipMirto: static RAM", "B", static_cast<double>(robot.data + robot.bss), 610, 601},
        {"AsipMirto: flash", "B", static_cast<double>(robot.text + robot.data), 13000, 12020},
        {"AsipMirto: steps lost at 2 x 4 kHz under a flood", "", lost_steps(), 0.5, 0.5},
        {"AsipMirto: latest report of 25 ms", "ms", latest_report(), 2, 1, false, 2},
        {"LCD, 18 pixels, four I2C sensors: static RAM", "B",
         static_cast<double>(displays.data + displays.bss), 900, 875},
        {"LCD, 18 pixels, four I2C sensors: flash", "B", static_cast<double>(displays.text + displays.data),
         18000, 17040},
        {"two DHT22: static RAM", "B", static_cast<double>(climate.data + climate.bss), 370, 363},
        {"two DHT22: flash", "B", static_cast<double>(climate.text + climate.data), 9000, 8806},
        {"eight thermometers: static RAM", "B", static_cast<double>(thermometers.data + thermometers.bss),
         450, 443},
        {"eight thermometers: flash", "B", static_cast<double>(thermometers.text + thermometers.data), 10200,
         10074},
        {"eight thermometers and OneWire: static RAM", "B", static_cast<double>(one_wire.data + one_wire.bss),
         500, 496},
        {"eight thermometers and OneWire: flash", "B", static_cast<double>(one_wire.text + one_wire.data),
         11500, 10956},
        {"BME280: static RAM", "B", static_cast<double>(weather.data + weather.bss), 385, 378},
        {"BME280: flash", "B", static_cast<double>(weather.text + weather.data), 10700, 10570},
        {"two steppers: static RAM", "B", static_cast<double>(steppers.data + steppers.bss), 465, 459},
        {"two steppers: flash", "B", static_cast<double>(steppers.text + steppers.data), 10700, 10496},
        {"SHT31 and BH1750: static RAM", "B", static_cast<double>(room.data + room.bss), 380, 375},
        {"SHT31 and BH1750: flash", "B", static_cast<double>(room.text + room.data), 9400, 9278},
        {"I2C chips: static RAM", "B", static_cast<double>(chips.data + chips.bss), 370, 358},
        {"I2C chips: flash", "B", static_cast<double>(chips.text + chips.data), 9500, 9410},
        {"round trip / wire at 57600", "", slow.cycles / slow.wire, 1.01, 1.01, false, 4},
        {"round trip at 500,000", "ms", fast.cycles / kCyclesPerMs, 0.45, 0.40, false, 3},
        {"round trip / wire at 1,000,000", "", fastest.cycles / fastest.wire, 1.25, 1.17, false, 2},
        {"square wave followed at 500,000", "Hz", fastest_square_wave(500000), 2770, 2770, true},
        {"square wave followed at 1,000,000", "Hz", fastest_square_wave(1000000), 3500, 5000, true},
    };
}

}  // namespace asip::firmware
