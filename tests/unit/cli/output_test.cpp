// SPDX-License-Identifier: Apache-2.0
#include "cli/output.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace asip::cli {
namespace {

using ::testing::HasSubstr;
using Count = RecordPrinter::Count;

std::string printed(const OutputOptions& options, Count count) {
    std::ostringstream out;
    RecordPrinter records(options, count, out);
    records.print({{"board", "uno1"}, {"services", {"io", "servo"}}});
    if (count != Count::kOne) records.print({{"board", "uno2"}});
    records.finish();
    return out.str();
}

TEST(RecordPrinter, Json_IsOneDocument) {
    EXPECT_EQ(nlohmann::json::parse(printed({Output::kJson, {}}, Count::kOne))["board"], "uno1");
    EXPECT_EQ(nlohmann::json::parse(printed({Output::kJson, {}}, Count::kList)).size(), 2U);
}

TEST(RecordPrinter, EmptyList_IsAnEmptyArray) {
    std::ostringstream out;
    RecordPrinter({Output::kJson, {}}, Count::kList, out).finish();
    EXPECT_EQ(out.str(), "[]\n");
}

TEST(RecordPrinter, JsonLines_IsAnObjectALine) {
    for (const auto count : {Count::kList, Count::kStream}) {
        EXPECT_EQ(printed({Output::kJsonLines, {}}, count),
                  "{\"board\":\"uno1\",\"services\":[\"io\",\"servo\"]}\n{\"board\":\"uno2\"}\n");
    }
}

TEST(RecordPrinter, JsonStream_IsOneDocumentAfterTheOther) {
    EXPECT_THAT(printed({Output::kJson, {}}, Count::kStream), HasSubstr("}\n{\n"));
}

TEST(RecordPrinter, Template_IsFilledFromEachRecord) {
    EXPECT_EQ(printed({Output::kTable, "{board}: {services.1}"}, Count::kList), "uno1: servo\nuno2: \n");
}

TEST(CheckTemplate, UnknownMember_IsRefusedWithTheNearest) {
    EXPECT_TRUE(check_template("{board} {data.x.0}", {"board", "data"}));
    const auto checked = check_template("{borad}", {"board", "data"});
    ASSERT_FALSE(checked);
    EXPECT_THAT(checked.error(), HasSubstr("did you mean \"board\"?"));
    EXPECT_THAT(checked.error(), HasSubstr("there are board, data"));
    EXPECT_FALSE(check_template("{board", {"board"}));
}

TEST(ValueAt, Paths_LeadIntoObjectsAndArrays) {
    const auto value = nlohmann::json::parse(R"({"a":[1,{"b":"x"}]})");
    EXPECT_EQ(value_at(value, "a.1.b"), "x");
    EXPECT_EQ(value_at(value, "a.0"), "1");
    EXPECT_EQ(value_at(value, "a"), R"([1,{"b":"x"}])");
    for (const auto* path : {"a.2", "a.x", "b", "a.-1", "a..0"})
        EXPECT_EQ(value_at(value, path), "") << path;
}

}  // namespace
}  // namespace asip::cli
