// Every standard model, and the one that docs/service-models.md teaches with, against its own examples.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

/// The first JSON block of the page.
ModelPtr taught_model() {
    std::ifstream file(ASIP_SOURCE_DIR "/docs/service-models.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    constexpr std::string_view kOpen = "```json\n";
    const auto begin = page.find(kOpen) + kOpen.size();
    const auto model = parse_service_model(page.substr(begin, page.find("```", begin) - begin));
    if (!model) throw std::runtime_error("docs/service-models.md: " + model.error());
    return std::make_shared<const ServiceModel>(*model);
}

std::vector<ModelPtr> tested_models() {
    auto models = ModelSet::standard().all();
    models.push_back(taught_model());
    return models;
}

class StandardModel : public testing::TestWithParam<ModelPtr> {
  protected:
    const ModelPtr model_ = GetParam();
    const std::vector<ModelExample> examples_ = examples(*model_);
};

TEST_P(StandardModel, EventExample_DecodesToItsJson) {
    for (const auto& example : examples_) {
        if (!example.is_event()) continue;
        const auto message = protocol::parse_line(example.wire);
        const auto* event = std::get_if<protocol::Event>(&message);
        ASSERT_NE(event, nullptr) << example.wire;
        EXPECT_EQ(event->service, model_->id) << example.wire;
        const auto ports = example.port_map.empty() ? protocol::PortMap{}
                                                    : protocol::PortMap::parse(example.port_map).value();
        const auto decoded = decode_event(*model_, *event, {&ports, {}});
        ASSERT_TRUE(decoded) << example.wire << ": " << decoded.error();
        EXPECT_EQ(dump_json(*decoded), example.json) << example.wire;
    }
}

TEST_P(StandardModel, CommandExample_EncodesToItsLine) {
    for (const auto& example : examples_) {
        if (example.is_event() || example.wire.empty()) continue;
        const auto encoded = encode_json_command(*model_, parse_json(example.json).value());
        ASSERT_TRUE(encoded) << example.json << ": " << encoded.error();
        EXPECT_EQ(encoded->line, example.wire) << example.json;
    }
}

TEST_P(StandardModel, CommandExample_EncodesFromItsOwnLineAsWell) {
    for (const auto& example : examples_) {
        if (example.is_event() || example.wire.empty()) continue;
        const auto encoded = encode_text_command(*model_, example.wire.substr(2));
        ASSERT_TRUE(encoded) << example.wire << ": " << encoded.error();
        EXPECT_EQ(encoded->line, example.wire);
    }
}

TEST_P(StandardModel, ErrorExample_IsRefusedWithItsReason) {
    for (const auto& example : examples_) {
        if (example.error.empty()) continue;
        const auto encoded = encode_json_command(*model_, parse_json(example.json).value());
        ASSERT_FALSE(encoded) << example.json << " gave " << encoded->line;
        EXPECT_EQ(encoded.error(), example.error) << example.json;
    }
}

TEST_P(StandardModel, Examples_CoverEachEventEachCommandAndAnError) {
    std::string all;
    bool any_error = false;
    for (const auto& example : examples_) {
        all += example.wire + "\n";
        any_error = any_error || !example.error.empty();
    }
    for (const auto& event : model_->events) {
        EXPECT_NE(all.find(std::string{'@', model_->id, ',', event.tag}), std::string::npos) << event.name;
    }
    for (const auto& command : model_->commands) {
        EXPECT_NE(("\n" + all).find(std::string{'\n', model_->id, ',', command.tag}), std::string::npos)
            << command.name;
    }
    EXPECT_TRUE(any_error);
}

INSTANTIATE_TEST_SUITE_P(All, StandardModel, testing::ValuesIn(tested_models()),
                         [](const auto& each) { return each.param->name; });

}  // namespace
}  // namespace asip::model
