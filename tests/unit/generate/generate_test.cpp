// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/generate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/model/model_set.hpp"
#include "cli/generate/layout.hpp"
#include "cli/generate/render.hpp"

#include <nlohmann/json.hpp>

namespace asip::generate {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A model with this between its braces, behind what every model has.
model::ServiceModel model_with(const std::string& members, const std::string& id = "F") {
    const auto model =
        model::parse_service_model(R"({"name":"fan","version":1,"id":")" + id +
                                   R"(","match":["Fan"],"title":"Fans","element":"fan",)" + members + "}");
    if (!model) throw std::runtime_error(model.error());
    return *model;
}

std::string firmware_fault(const model::ServiceModel& model) {
    const auto files = firmware(model, "Fan", 2);
    return files ? "none" : files.error();
}

std::string text_of(const Files& files, const std::string& name) {
    if (!files) return files.error();
    for (const auto& file : *files)
        if (file.name == name) return file.text;
    return "no " + name;
}

TEST(Templates, LinesOfSections_LeaveNothing) {
    const auto text =
        "a\n<%#list%>\n    <%name%><%#more%>,<%/more%>\n<%/list%>\n<%^list%>\nnone\n<%/list%>\n\nb\n";
    EXPECT_EQ(render(text, {{"list", {{{"name", "x<"}, {"more", true}}, {{"name", "y"}}}}}),
              "a\n    x<,\n    y\n\nb\n");
    EXPECT_EQ(render(text, {{"list", nlohmann::json::array()}}), "a\nnone\n\nb\n");
    EXPECT_THROW(render("<%#open%>", {}), std::logic_error);
    EXPECT_THROW(template_text("nothing"), std::logic_error);
}

TEST(Elements, AreAsManyAsTheExamplesShow) {
    EXPECT_EQ(elements_in_examples(*model::ModelSet::standard().find("reflectance")), 3U);
    EXPECT_EQ(elements_in_examples(*model::ModelSet::standard().find("servo")), 2U);
    EXPECT_EQ(elements_in_examples(*model::ModelSet::standard().find("tone")), 1U);
}

TEST(Firmware, WhatItCannotExpress_IsRefusedWithItsPlace) {
    EXPECT_EQ(
        firmware_fault(model_with(R"("events":{"d":{"name":"pins","shape":"ports"}})")),
        "/events/d: the shape \"ports\" is that of the pins, which each board brings already; use a list");
    EXPECT_THAT(firmware_fault(model_with(R"("commands":{})", "I")),
                HasSubstr("/id: I is the letter of the pins"));
    EXPECT_EQ(firmware_fault(model_with(R"("commands":{"a":{"tag":"X"},"b":{"tag":"X"}})")),
              "/commands/b: a has the tag X already; a board could not tell them apart");
    EXPECT_EQ(firmware_fault(model_with(
                  R"("commands":{"a":{"tag":"X","args":[{"name":"n","type":"integer","max":5000000000}]}})")),
              "/commands/a: n: its numbers do not fit 32 bits; give it a smaller min and max");
    EXPECT_EQ(
        firmware_fault(model_with(
            R"("commands":{"a":{"tag":"X","args":[{"name":"n","type":"integer","min":0.2,"max":0.8}]}})")),
        "/commands/a: n: there is no whole number from its min to its max");
    EXPECT_THAT(firmware_fault(model_with(R"("commands":{"a":{"tag":"X","args":[{"name":"l","type":"list",)"
                                          R"("items":[{"name":"t","type":"text"}]}]}})")),
                HasSubstr("items of a list that are text are not supported"));
    EXPECT_THAT(
        firmware_fault(model_with(R"("events":{"e":{"name":"s","fields":[{"name":"s","type":"integer"}]}},)"
                                  R"("commands":{"all":{"tag":"A"}})")),
        HasSubstr("/commands/all: tag A sets the period of reports"));
}

TEST(Firmware, NamesThatBecomeOne_AreRefused) {
    const auto model = model_with(R"("commands":{"a-b":{"tag":"X"},"a_b":{"tag":"Y"}})");
    EXPECT_EQ(firmware_fault(model), "command a-b and command a_b both become doAB in C++: rename one");
    EXPECT_EQ(cpp_client(model).error(), "command a-b and command a_b both become a_b in C++: rename one");
    EXPECT_THAT(
        firmware_fault(model_with(R"("commands":{"a":{"tag":"X","args":[)"
                                  R"({"name":"b-c","type":"integer"},{"name":"b_c","type":"integer"}]}})")),
        HasSubstr("both become bC in C++"));
}

TEST(Firmware, AnnouncedName_IsOneThatTheWireCarries) {
    EXPECT_EQ(announced_name(model_with(R"("commands":{})")), "Fan");
    const auto odd = model::parse_service_model(
        R"({"name":"fan","version":1,"id":"F","match":["{},:","A, {fan}: \"x\"; é"],"title":"Fans"})");
    EXPECT_EQ(announced_name(*odd), "A fan x");
    const auto none =
        model::parse_service_model(R"({"name":"fan","version":1,"id":"F","match":["é"],"title":"Fans"})");
    EXPECT_EQ(announced_name(*none), "fan");
}

TEST(Firmware, ElementOfAnyRange_IsNeitherNegativeNorBeyondTheLast) {
    for (const char* range : {"", R"(,"min":-5,"max":4000000)", R"(,"min":-9,"max":-1)"}) {
        const auto model =
            model_with(R"("commands":{"stop":{"tag":"S","args":[{"name":"fan","type":"integer")" +
                       std::string(range) + "}]}}");
        const auto text = text_of(firmware(model, "Fan", 2), "FanService.cpp");
        EXPECT_THAT(text, HasSubstr("const uint16_t fan = request.number(")) << range;
        EXPECT_THAT(text, HasSubstr("if (fan >= kElements) return asip::Error::kInvalidDeviceNumber;"))
            << range;
    }
}

TEST(Firmware, HardwareFile_IsOfThePerson) {
    const auto files = firmware(model_with(R"("commands":{"stop":{"tag":"S"}})"), "Fan", 2);
    ASSERT_TRUE(files);
    for (const auto& file : *files)
        EXPECT_EQ(file.own_code, file.name == "FanHardware.cpp") << file.name;
    EXPECT_THAT(text_of(files, "FanHardware.cpp"), HasSubstr("// your code"));
    EXPECT_THAT(text_of(files, "FanService.cpp"), Not(HasSubstr("readWhole")));
}

TEST(Firmware, ValuesWithoutAPin_AreZeroUntilSomebodyWritesThem) {
    const auto model =
        model_with(R"("events":{"e":{"name":"speed","fields":[{"name":"speed","type":"integer"}]}})");
    EXPECT_THAT(text_of(firmware(model, "Fan", 6), "FanHardware.cpp"), HasSubstr("{A0, A1, A2, A3, A4, A5}"));
    EXPECT_THAT(text_of(firmware(model, "Fan", 7), "FanHardware.cpp"),
                HasSubstr("(void)fan;\n    return 0;"));
    EXPECT_FALSE(simulated_part(model, "x.elf", 7));
}

}  // namespace
}  // namespace asip::generate
