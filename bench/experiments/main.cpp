// SPDX-License-Identifier: Apache-2.0
// The experiments of the ASIP papers, each as a table, a CSV file and a plot.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include "bench/experiments/experiment.hpp"

namespace {

using namespace asip::experiments;

constexpr Experiment kExperiments[] = {
    {"footprint", "RAM and flash of the firmware", footprint},
    {"latency", "pin 13 wired to pin 2: from a write to the event, over serial port, TCP and MQTT", latency},
    {"throughput", "the fastest square wave of which no edge is lost, over serial port, TCP and MQTT",
     throughput},
    {"switch", "a button on one board switches a LED on another", two_board_switch},
    {"discovery", "four boards: the time until all see each other, with late joiners", discovery},
    {"pid", "a robot follows a line: by the period of its reports and by the latency of the path", pid},
};

std::string list() {
    std::string text = "Experiments:\n";
    for (const auto& experiment : kExperiments)
        text += "  " + std::string(experiment.name) + std::string(12 - experiment.name.size(), ' ') +
                std::string(experiment.about) + "\n";
    return text +
           "\nExamples:\n"
           "  experiments                             all of them\n"
           "  experiments latency throughput          two of them\n"
           "  experiments footprint latency --with-image my.elf\n"
           "                                          an image of another ASIP firmware, measured the same "
           "way\n"
           "\nExit status: 0 all were carried out; 1 one could not be; 2 wrong option.";
}

const Experiment* find(const std::string& name) {
    for (const auto& experiment : kExperiments)
        if (experiment.name == name) return &experiment;
    return nullptr;
}

bool carry_out(const Experiment& experiment, const Setup& setup, const std::filesystem::path& out) {
    const auto began = std::chrono::steady_clock::now();
    std::printf("\n== %s: %s\n", experiment.name.data(), experiment.about.data());
    std::fflush(stdout);
    try {
        for (const auto& results : experiment.run(setup)) {
            results.print();
            results.save(out);
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "experiments: %s: %s\n", experiment.name.data(), error.what());
        return false;
    }
    std::printf("-- %s: %.0f s, in %s\n", experiment.name.data(),
                std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
                out.string().c_str());
    return true;
}

}  // namespace

int main(int argc, char** argv) try {
    Setup setup;
    std::vector<std::string> names;
    std::filesystem::path out = "build/experiments";
    CLI::App app{"The experiments of the ASIP papers, on simulated boards with real firmware."};
    app.footer(list());
    app.add_option("NAME", names, "Which; otherwise all")->check([](const std::string& name) {
        return find(name) ? std::string() : "there is no experiment \"" + name + "\"; --help lists them";
    });
    app.add_option(
           "--with-image", setup.other_image,
           "Image (.elf) of another ASIP firmware for an Uno, measured beside ours: footprint, latency, "
           "throughput, switch")
        ->check(CLI::ExistingFile);
    app.add_option("--out", out, "Folder for CSV and SVG files")->capture_default_str();
    app.add_flag("--quick", setup.quick, "A small part of each: shows that it works, gives no figures");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (!setup.other_image.empty()) setup.other_image = std::filesystem::absolute(setup.other_image).string();
    std::filesystem::create_directories(out);
    bool good = true;
    for (const auto& experiment : kExperiments)
        if (names.empty() || std::find(names.begin(), names.end(), experiment.name) != names.end())
            good = carry_out(experiment, setup, out) && good;
    return good ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "experiments: %s\n", error.what());
    return 1;
}
