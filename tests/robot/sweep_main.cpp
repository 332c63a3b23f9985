// How well the robot follows its line: over each path at several periods, and at several injected latencies
// until it leaves the line. Prints the tables; with --out, leaves them as CSV and SVG in a folder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/robot/lockstep.hpp"
#include "tests/robot/plot.hpp"

namespace {

using namespace asip::test;
using namespace std::chrono_literals;
using std::chrono::milliseconds;

struct Options {
    std::string image = ASIP_MIRTO;
    std::string world = ASIP_TRACK;
    std::filesystem::path out;
    unsigned laps = 2;
    std::vector<int> periods{5, 10, 20, 30, 50, 75, 100, 150, 200};
    std::vector<int> latencies{0, 5, 10, 20, 30, 50, 75, 100, 150, 200};
};

/// A table on standard output, and the same as CSV and as a plot.
class Table {
  public:
    Table(std::string title, std::string x_label)
        : plot_{std::move(title), std::move(x_label), "root mean square distance from the line, mm", {}} {
        std::printf("\n%s\n%-18s %-8s %9s %9s %9s\n", plot_.title.c_str(), plot_.x_label.c_str(), "path",
                    "lap, s", "rms, mm", "max, mm");
        csv_ = plot_.x_label + ",path,lap_s,rms_mm,max_mm\n";
    }
    void begin(const std::string& curve) { plot_.curves.push_back({curve, {}, {}}); }
    void add(int x, const Driven& driven, unsigned laps) {
        auto& curve = plot_.curves.back();
        if (!driven.ok(laps)) {
            std::printf("%-18d %-8s  %s\n", x, curve.name.c_str(),
                        driven.stayed ? "too slow" : "leaves the line");
            csv_ += fmt::format("{},{},,,\n", x, curve.name);
            curve.failed.push_back(x);
        } else {
            std::printf("%-18d %-8s %9.3f %9.2f %9.2f\n", x, curve.name.c_str(), driven.lap_seconds(),
                        driven.rms_mm(), driven.laps.back().max_mm);
            csv_ += fmt::format("{},{},{:.3f},{:.3f},{:.3f}\n", x, curve.name, driven.lap_seconds(),
                                driven.rms_mm(), driven.laps.back().max_mm);
            curve.points.emplace_back(x, driven.rms_mm());
        }
        std::fflush(stdout);
    }
    void save(const std::filesystem::path& folder, const std::string& name) const {
        if (folder.empty()) return;
        std::ofstream(folder / (name + ".csv")) << csv_;
        std::ofstream(folder / (name + ".svg")) << plot_.svg();
    }

  private:
    Plot plot_;
    std::string csv_;
};

void sweep_periods(const Options& options) {
    Table table("Reports every so many milliseconds, published gains", "period, ms");
    for (const auto& path : {serial_path(), tcp_path(), mqtt_path()}) {
        table.begin(path.name);
        for (const int period : options.periods)
            table.add(period,
                      drive({.path = path, .period = milliseconds(period), .laps = options.laps},
                            options.image, options.world),
                      options.laps);
    }
    table.save(options.out, "period");
}

void sweep_latencies(const Options& options) {
    Table table("Latency added each way, published gains", "latency, ms");
    for (const int period : {20, 50}) {
        table.begin(fmt::format("{} ms", period));
        for (const int latency : options.latencies) {
            const auto driven = drive({.path = {"injected", milliseconds(latency), 0us, 0},
                                       .period = milliseconds(period),
                                       .laps = options.laps},
                                      options.image, options.world);
            table.add(latency, driven, options.laps);
            if (!driven.ok(options.laps)) break;
        }
    }
    table.save(options.out, "latency");
}

}  // namespace

int main(int argc, char** argv) try {
    Options options;
    CLI::App app{"Sweeps of the line follower, in simulated time."};
    app.add_option("--image", options.image, "Firmware image");
    app.add_option("--world", options.world, "World file");
    app.add_option("--out", options.out, "Folder for CSV and SVG");
    app.add_option("--laps", options.laps, "Of each drive; the first is not counted")
        ->check(CLI::Range(1, 100));
    app.add_option("--periods", options.periods, "Milliseconds, as 20,50")->delimiter(',');
    app.add_option("--latencies", options.latencies, "Milliseconds each way, as 0,50")->delimiter(',');
    CLI11_PARSE(app, argc, argv);
    if (!options.out.empty()) std::filesystem::create_directories(options.out);
    sweep_periods(options);
    sweep_latencies(options);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "robot_sweep: %s\n", error.what());
    return 1;
}
