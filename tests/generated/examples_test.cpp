// SPDX-License-Identifier: Apache-2.0
// The firmware that is made of each model, in a simulated chip, against the examples of the model; and what
// is made for asip-sim.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/model_set.hpp"
#include "asip/protocol/message.hpp"
#include "cli/generate/generate.hpp"
#include "cli/generate/layout.hpp"
#include "firmware_board.hpp"
#include "sim/board_file.hpp"
#include "tests/support/words.hpp"

namespace asip::generate {
namespace {

using model::ModelExample;
using model::ServiceModel;
using testing::HasSubstr;

ServiceModel load(const std::string& file) {
    auto model = model::load_service_model(file);
    if (!model) throw std::runtime_error(model.error());
    return std::move(*model);
}

/// The request that a client would send which checks nothing; nothing where the example is of another kind of
/// mistake than a number out of range.
std::optional<std::string> unchecked_request(const ServiceModel& model, const ModelExample& example) {
    const auto document = nlohmann::json::parse(example.json);
    const auto* command = model.command(document.begin().key());
    if (command == nullptr) return std::nullopt;
    const auto values = model::argument_values(*command, document.begin().value());
    if (!values || values->size() != command->args.size()) return std::nullopt;
    std::string line{model.id, ',', command->tag};
    for (const auto& value : *values) {
        // A board takes the whole part of a decimal number, as boards always did, and a number is text to it.
        if (value.is_number_float() && example.error.ends_with("is not an integer")) return std::nullopt;
        if (example.error.ends_with("is not a string")) return std::nullopt;
        if (value.is_number())
            line += "," + value.dump();
        else if (value.is_string() && &value == &values->back() &&
                 example.error.find("text") == std::string::npos)
            line += "," + value.get<std::string>();
        else
            return std::nullopt;
    }
    return line;
}

/// An image with the services of several models, each with another letter.
struct Group {
    std::string image;
    std::vector<std::string> models;
    friend void PrintTo(const Group& group, std::ostream* out) { *out << group.image; }
};

std::vector<Group> groups() {
    std::vector<Group> all;
    for (const auto& group : test::words(GENERATED_GROUPS, ',')) {
        auto parts = test::words(group, ':');
        all.push_back({parts.front(), {parts.begin() + 1, parts.end()}});
    }
    return all;
}

class GeneratedFirmware : public testing::TestWithParam<Group> {
  protected:
    firmware::FirmwareBoard board_{GetParam().image};
};

TEST_P(GeneratedFirmware, EachService_IsAnnouncedByANameThatFindsItsModel) {
    const auto names = board_.ask("#,N");
    for (const auto& file : GetParam().models) {
        const auto model = load(file);
        const auto announced = announced_name(model);
        EXPECT_THAT(names, HasSubstr(std::string{model.id, ':'} + announced));
        EXPECT_TRUE(model.matches(model.id, announced)) << announced;
    }
}

TEST_P(GeneratedFirmware, EachCommandExample_IsExecutedAndAnsweredAsTheModelSays) {
    for (const auto& file : GetParam().models) {
        const auto model = load(file);
        for (const auto& example : examples(model)) {
            if (example.is_event() || example.wire.empty()) continue;
            const auto* command = model.command_with_tag(example.wire[2]);
            ASSERT_NE(command, nullptr) << example.wire;
            const auto answer = board_.ask(example.wire);
            if (command->tag == 'A') board_.ask(std::string{model.id} + ",A,0");
            if (command->answer == 0) {
                EXPECT_TRUE(answer.empty() || command->tag == 'A')
                    << example.wire << " was answered " << answer;
                continue;
            }
            const auto message = protocol::parse_line(answer);
            const auto* event = std::get_if<protocol::Event>(&message);
            ASSERT_NE(event, nullptr) << example.wire << " was answered " << answer;
            EXPECT_EQ(event->tag, command->answer);
            const auto decoded = decode_event(model, *event);
            EXPECT_TRUE(decoded) << answer << ": " << decoded.error();
        }
    }
}

TEST_P(GeneratedFirmware, EachRefusedExample_IsRefusedByTheBoardToo) {
    std::size_t tried = 0;
    for (const auto& file : GetParam().models) {
        const auto model = load(file);
        for (const auto& example : examples(model)) {
            if (example.error.empty()) continue;
            const auto line = unchecked_request(model, example);
            if (!line) continue;
            ++tried;
            const auto expected = std::string({'~', model.id, ',', (*line)[2]}) + ",11{BAD_ARGUMENT}";
            EXPECT_EQ(board_.ask(*line), expected) << *line;
        }
    }
    EXPECT_GT(tried, 0U);
}

TEST_P(GeneratedFirmware, UnknownTag_IsRefused) {
    for (const auto& file : GetParam().models) {
        const auto model = load(file);
        const std::string letter(1, model.id);
        EXPECT_EQ(board_.ask(letter + ",Z"), "~" + letter + ",Z,2{UNKNOWN_REQUEST}");
    }
}

INSTANTIATE_TEST_SUITE_P(All, GeneratedFirmware, testing::ValuesIn(groups()),
                         [](const auto& each) { return each.param.image; });

TEST(GeneratedPart, OfEachModelWithNumbers_IsAWholeBoardFile) {
    std::vector<std::string> refused;
    for (const auto& file : test::words(GENERATED_MODELS, ':')) {
        const auto model = load(file);
        const auto files = simulated_part(model, "x.elf", elements_in_examples(model));
        if (!files) {
            refused.push_back(model.name);
            continue;
        }
        const auto board = sim::parse_board_file(files->front().text, files->front().name);
        EXPECT_TRUE(board) << model.name << ": " << board.error();
    }
    EXPECT_THAT(refused, testing::UnorderedElementsAre("io", "lcd"));
}

}  // namespace
}  // namespace asip::generate
