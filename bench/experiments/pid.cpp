// SPDX-License-Identifier: Apache-2.0
// How well the robot follows its line: over each path at several periods, and at several injected latencies
// until it leaves the line. In simulated time: exact, and the same each time.
#include <fmt/format.h>

#include <atomic>
#include <thread>

#include "bench/experiments/experiment.hpp"
#include "bench/experiments/rig.hpp"
#include "tests/robot/lockstep.hpp"

namespace asip::experiments {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

constexpr unsigned kLaps = 2;  // the first, which begins at rest, is not counted where there are two

struct PlannedDrive {
    int x;  // place on the axis
    std::string curve;
    test::Drive how;
    test::Driven driven{};
};

/// As many at a time as there are cores.
void drive_all(std::vector<PlannedDrive>& runs) {
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> failed = false;
    std::string why;
    const auto work = [&] {
        for (std::size_t i = next++; i < runs.size() && !failed; i = next++)
            try {
                runs[i].driven = test::drive(runs[i].how, ASIP_IMAGES "/asip_uno_mirto.elf", ASIP_TRACK);
            } catch (const std::exception& error) {
                if (!failed.exchange(true)) why = error.what();
            }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
        threads.emplace_back(work);
    threads.clear();
    if (failed) throw std::runtime_error(why);
}

Results table(std::string name, std::string title, const std::string& x_label,
              std::vector<PlannedDrive> runs) {
    drive_all(runs);
    Results results{
        .name = std::move(name),
        .title = std::move(title),
        .columns = {x_label, "path", "lap, s", "rms, mm", "max, mm"},
        .rows = {},
        .notes =
            {"the published gains (power 50, Kp 0.015, Ki = Kd = 0, cut-off 50) on sim/worlds/track.json, "
             "3 m, line stepped up to 500,000 baud; published period: 50 ms",
             "one process and simulated time: board, session, line follower; the path is latency that "
             "is injected. The papers: a robot on a floor, which is not ours"},
        .pictures = {}};
    Plot plot{results.title, x_label, "root mean square distance from the line, mm", {}};
    for (const auto& run : runs) {
        if (plot.curves.empty() || plot.curves.back().name != run.curve)
            plot.curves.push_back({run.curve, {}, {}});
        const auto& driven = run.driven;
        if (!driven.ok(run.how.laps)) {
            results.rows.push_back(
                {std::to_string(run.x), run.curve, driven.stayed ? "too slow" : "leaves the line", "", ""});
            plot.curves.back().failed.push_back(run.x);
            continue;
        }
        results.rows.push_back({std::to_string(run.x), run.curve, number(driven.lap_seconds(), 3),
                                number(driven.rms_mm(), 2), number(driven.laps.back().max_mm, 1)});
        plot.curves.back().points.emplace_back(run.x, driven.rms_mm());
    }
    results.pictures = {{"", plot.svg()}};
    return results;
}

}  // namespace

std::vector<Results> pid(const Setup& setup) {
    const unsigned laps = setup.quick ? 1 : kLaps;
    const std::vector<int> periods =
        setup.quick ? std::vector{50} : std::vector{5, 10, 20, 50, 100, 150, 200};
    std::vector<PlannedDrive> by_period;
    for (const auto& path : {test::serial_path(), test::tcp_path(), test::mqtt_path()})
        for (const int period : periods)
            if (!setup.quick || path.name == "mqtt")
                by_period.push_back(
                    {period, path.name, {.path = path, .period = milliseconds(period), .laps = laps}});
    std::vector<PlannedDrive> by_latency;
    const std::vector<int> latencies =
        setup.quick ? std::vector{100} : std::vector{0, 10, 20, 30, 40, 50, 75};
    for (const int period : setup.quick ? std::vector{50} : std::vector{20, 50})
        for (const int latency : latencies)
            by_latency.push_back({latency,
                                  fmt::format("{} ms", period),
                                  {.path = {"injected", milliseconds(latency), 0us, 0},
                                   .period = milliseconds(period),
                                   .laps = laps}});
    return {table("pid-period", "The robot's distance from its line, by the period of its reports",
                  "period, ms", std::move(by_period)),
            table("pid-latency", "The robot's distance from its line, by the latency each way", "latency, ms",
                  std::move(by_latency))};
}

}  // namespace asip::experiments
