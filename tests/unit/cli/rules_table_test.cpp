// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/secure/topic_rules.hpp"

namespace asip::cli {
namespace {

std::string rights_text(const Rights& rights) {
    static constexpr std::array<std::string_view, 7> kWords{
        "read", "write", "read own", "write own", "read own", "write own", "write as `registry`"};
    std::string text;
    for (const auto right : rights)
        text.append(text.empty() ? "" : ", ").append(kWords[static_cast<std::size_t>(right)]);
    return text;
}

/// Memory, processor and disk, in this order; what costs nothing is left out.
std::string costs_text(const TopicRule& rule) {
    std::string text;
    for (const auto* cost : {&rule.memory, &rule.processor, &rule.disk})
        if (*cost != "-") text.append(text.empty() ? "" : "; ").append(*cost);
    return text;
}

/// As the table of SECURITY.md.
std::string rules_table() {
    // Topics with one text of rights and costs share a row.
    std::vector<std::pair<std::string, std::string>> rows;
    for (const auto& rule : topic_rules()) {
        const auto cells = rights_text(rule.board) + " | " + rights_text(rule.viewer) + " | " +
                           rights_text(rule.commander) + " | " + rights_text(rule.of(Role::kGateway)) +
                           " | " + rights_text(rule.home_assistant) + " | " + rights_text(rule.registry) +
                           " | " + costs_text(rule);
        const auto row =
            std::find_if(rows.begin(), rows.end(), [&](const auto& each) { return each.second == cells; });
        if (row == rows.end())
            rows.emplace_back("`" + rule.topic + "`", cells);
        else
            row->first += ", `" + rule.topic + "`";
    }
    std::string text =
        "| topic | board | viewer | operator | gateway | Home Assistant | registry | costs |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const auto& [topics, cells] : rows)
        text.append("| ").append(topics).append(" | ").append(cells).append(" |\n");
    return text;
}

/// ASIP_WRITE_TABLE=1 writes it.
TEST(SecureRoles, TableOfSecurityPage_IsThatOfTheRules) {
    const std::string path = ASIP_TEST_SOURCE "/SECURITY.md";
    const std::string begin = "<!-- from cli/secure/topic_rules.cpp -->\n", end = "<!-- end -->";
    std::ifstream file(path);
    std::string page{std::istreambuf_iterator<char>(file), {}};
    const auto from = page.find(begin) + begin.size();
    const auto to = page.find(end);
    ASSERT_NE(to, std::string::npos) << path;
    if (std::getenv("ASIP_WRITE_TABLE") != nullptr)
        std::ofstream(path) << page.substr(0, from) + rules_table() + page.substr(to);
    EXPECT_EQ(page.substr(from, to - from), rules_table());
}

}  // namespace
}  // namespace asip::cli
