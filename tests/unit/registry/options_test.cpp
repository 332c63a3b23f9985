// SPDX-License-Identifier: Apache-2.0
#include "registry/options.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

#include <optional>

#include "tests/support/temp_dir.hpp"

namespace asip::registry {
namespace {

using namespace std::chrono_literals;
using test::TempDir;

/// The size of the history that this option gives; nothing where it is refused.
std::optional<std::size_t> history_bytes(const char* size) {
    const TempDir folder;
    const auto file = folder.write("asip.conf", std::string("history-size = ") + size + "\n");
    const char* const arguments[] = {"asip-registry", "--config", file.c_str()};
    const auto options = read_options(3, arguments);
    if (!options) return std::nullopt;
    return options->history_bytes;
}

TEST(RegistryOptions, Sizes_AreBytesWithAUnit) {
    EXPECT_EQ(history_bytes("65536"), 65536U);
    EXPECT_EQ(history_bytes("512k"), 512U * 1024);
    EXPECT_EQ(history_bytes("256M"), 256U * 1024 * 1024);
    EXPECT_EQ(history_bytes("2GB"), std::size_t{2} * 1024 * 1024 * 1024);
    for (const char* bad : {"", "k", "1", "-1M", "1x", "99999999999999G"})
        EXPECT_FALSE(history_bytes(bad)) << bad;
}

TEST(RegistryOptions, PatternsOfValues_AreNamedOrBoardAndProperty) {
    const auto patterns = [](const std::string& text) {
        const TempDir folder;
        const auto file = folder.write("asip.conf", "values = " + text + "\n");
        const char* const arguments[] = {"asip-registry", "--config", file.c_str()};
        const auto options = read_options(3, arguments);
        return options ? std::optional(options->values) : std::nullopt;
    };
    EXPECT_EQ(patterns("named,desk/*,*/*/temperature"),
              (std::vector<std::string>{"desk/*", "*/*/temperature"}));
    for (const auto* bad : {"desk", "desk/", "/x", "named,", "none,desk/*", "desk/a, lamp/*", "named, */*"})
        EXPECT_FALSE(patterns(bad)) << bad;
}

std::optional<std::array<Duration, 3>> ages_of_values(const std::string& text) {
    const TempDir folder;
    const auto file = folder.write("asip.conf", "values-age = " + text + "\n");
    const char* const arguments[] = {"asip-registry", "--config", file.c_str()};
    const auto options = read_options(3, arguments);
    return options ? std::optional(options->values_age) : std::nullopt;
}

TEST(RegistryOptions, AgesOfValues_AreThree_TheCoarserTheLonger) {
    EXPECT_EQ(ages_of_values("48h,90d,1826d"), RegistryOptions().values_age);
    EXPECT_EQ(ages_of_values("6h,1d,1d"), (std::array<Duration, 3>{6h, 24h, 24h}));
    for (const char* bad : {"48h", "48h,90d", "48h,90d,1826d,", "48h,90d,1826d,9999d", "48h,,90d",
                            "90d,48h,1826d", "48h,90d,1d", "1,2,x", ",,"})
        EXPECT_FALSE(ages_of_values(bad)) << bad;
}

TEST(RegistryOptions, Periods_AreASecondOrMore) {
    EXPECT_EQ(parse_period("90"), Duration(90s));
    EXPECT_EQ(parse_period("15m"), Duration(15min));
    EXPECT_EQ(parse_period("7d"), Duration(7 * 24h));
    EXPECT_EQ(parse_period("1500ms"), Duration(1500ms));
    for (const char* bad : {"", "h", "0s", "500ms", "1w", "-1s", "99999999999999999999d", "40000d"})
        EXPECT_FALSE(parse_period(bad)) << bad;
}

std::string history_of(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "asip-registry");
    const auto options = read_options(static_cast<int>(arguments.size()), arguments.data());
    return options ? options->history : "refused";
}

TEST(Options, ServiceKeepsAHistory_UnlessItIsToldNotTo) {
    ::unsetenv("STATE_DIRECTORY");
    EXPECT_EQ(history_of({}), "");
    ::setenv("STATE_DIRECTORY", "/var/lib/asip:/elsewhere", 1);
    EXPECT_EQ(history_of({}), "/var/lib/asip/history.db");
    EXPECT_EQ(history_of({"--history", "/tmp/h.db"}), "/tmp/h.db");
    EXPECT_EQ(history_of({"--history", "none"}), "");
    ::unsetenv("STATE_DIRECTORY");
}

}  // namespace
}  // namespace asip::registry
