// SPDX-License-Identifier: Apache-2.0
// What anyone may publish on a control topic. First byte: which standard service it is for.
#include <cstdint>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/model/model_set.hpp"
#include "asip/protocol/request.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip;

void check_line(const model::EncodedCommand& command) {
    const auto request = protocol::parse_request(command.line);
    REQUIRE(request.has_value());
    REQUIRE(request->service == command.service && request->tag == command.tag);
}

void check(const Expected<model::EncodedCommand>& command, const model::ServiceModel* model) {
    if (!command) {
        REQUIRE(!command.error().empty());
        return;
    }
    check_line(*command);
    if (model == nullptr) return;
    // What was accepted is accepted again in the wire's own form, and means the same.
    const auto again = model::encode_text_command(*model, std::string_view(command->line).substr(2));
    REQUIRE(again.has_value() && again->line == command->line);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const auto& models = model::ModelSet::standard().all();
    const auto& model = *models[data[0] % models.size()];
    const std::string_view payload(reinterpret_cast<const char*>(data) + 1, size - 1);
    check(model::encode_control_text(&model, model.id, payload), &model);
    check(model::encode_control_text(nullptr, 'X', payload), nullptr);
    if (const auto object = model::parse_json(payload)) {
        check(model::encode_control_json(&model, model.id, *object), &model);
        check(model::encode_control_json(nullptr, 'X', *object), nullptr);
    }
    std::vector<std::string> words(1);
    for (const char c : payload.substr(0, 200))
        if (c == ' ')
            words.emplace_back();
        else
            words.back() += c;
    if (const auto command = model::encode_word_command(model, words)) check_line(*command);
    return 0;
}
