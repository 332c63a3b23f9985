// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "asip/expected.hpp"
#include "gateway/export/home_assistant.hpp"
#include "gateway/export/homie.hpp"
#include "gateway/export/sparkplug.hpp"
#include "gateway/options.hpp"

namespace asip::program {
class App;
class Settings;
}  // namespace asip::program

namespace asip::gateway {

/// From the command line.
struct ExportOptions {
    std::string home_assistant, homie_domain, sparkplug_group;
    exports::HomeAssistant::Options home;
    exports::Homie::Options homie;
    exports::Sparkplug::Options sparkplug;
    double per_second = 5;  // states of one entity
    bool no_wot = false;
    std::optional<std::string> clean;  // which exports are cleared; empty: all
};

void declare_exports(program::App& app, program::Settings& settings, ExportOptions& raw);

/// Adds the exports to `options`, whose gateway and connection are known. Fails with a sentence.
Expected<void> make_exports(ExportOptions& raw, const program::App& app, ProgramOptions& options);

}  // namespace asip::gateway
