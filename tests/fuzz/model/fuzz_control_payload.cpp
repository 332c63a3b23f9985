// What anyone may publish on a control topic. First byte: which standard service it is for.
#include <cstdint>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/model_set.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip;

void check_line(const model::EncodedCommand& command) {
    const auto request = protocol::parse_request(command.line);
    REQUIRE(request.has_value());
    REQUIRE(request->service == command.service && request->tag == command.tag);
}

void check_request(const model::ControlRequest& request, const model::ServiceModel* model) {
    REQUIRE(request.id.size() <= 64 && request.reply_to.size() <= 256);
    REQUIRE(request.reply_to.find_first_of("+#") == std::string::npos);
    if (!request.command) {
        REQUIRE(!request.command.error().empty());
        return;
    }
    check_line(*request.command);
    if (model == nullptr) return;
    // What was accepted is accepted again in the wire's own form, and means the same.
    const auto again = model::encode_text_command(*model, std::string_view(request.command->line).substr(2));
    REQUIRE(again.has_value() && again->line == request.command->line);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const auto& models = model::ModelSet::standard().all();
    const auto& model = *models[data[0] % models.size()];
    const std::string_view payload(reinterpret_cast<const char*>(data) + 1, size - 1);
    check_request(model::read_control(&model, model.id, payload), &model);
    check_request(model::read_control(nullptr, 'X', payload), nullptr);
    const auto raw = model::read_raw_control(payload);
    if (raw.lines) {
        for (const auto& line : *raw.lines)
            REQUIRE(protocol::parse_request(line).has_value());
    }
    std::vector<std::string> words(1);
    for (const char c : payload.substr(0, 200)) {
        if (c == ' ')
            words.emplace_back();
        else
            words.back() += c;
    }
    if (const auto command = model::encode_word_command(model, words)) check_line(*command);
    return 0;
}
