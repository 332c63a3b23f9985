#include "registry/options.hpp"

#include <gtest/gtest.h>

namespace asip::registry {
namespace {

using namespace std::chrono_literals;
TEST(RegistryOptions, TimesAndSizes) {
    EXPECT_EQ(parse_period("90"), Duration(90s));
    EXPECT_EQ(parse_period("15m"), Duration(15min));
    EXPECT_EQ(parse_period("7d"), Duration(7 * 24h));
    EXPECT_EQ(parse_period("1500ms"), Duration(1500ms));
    EXPECT_EQ(parse_size("512k"), 512u * 1024);
    for (const char* bad : {"", "h", "0s", "500ms", "1w", "-1s", "99999999999999999999d", "40000d"}) {
        EXPECT_FALSE(parse_period(bad)) << bad;
    }
    for (const char* bad : {"", "k", "1", "-1M", "1T", "99999999999999G"})
        EXPECT_FALSE(parse_size(bad)) << bad;
}

}  // namespace
}  // namespace asip::registry
