// SPDX-License-Identifier: Apache-2.0
#include "sim/board_file.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "asip/text/file_text.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/nearest.hpp"
#include "sim/board_kind.hpp"
#include "sim/wiring/part_plan.hpp"
#include "sim/world/world_file.hpp"

namespace asip::sim {
namespace {

using nlohmann::json;
using text::JsonReader;

/// Kind and settings are looked at later, when all parts are known.
PartConfig read_part(JsonReader& reader) {
    PartConfig part{reader.text("kind"), reader.value(), reader.text("name")};
    if (!part.settings.is_object()) return part;
    part.settings.erase("kind");
    part.settings.erase("name");
    return part;
}

std::filesystem::path beside(const std::filesystem::path& file, const std::string& path) {
    return path.empty() ? std::filesystem::path() : file.parent_path() / path;
}

BoardFile read_board(JsonReader reader, const std::filesystem::path& file) {
    BoardFile result;
    auto& board = result.board;
    board.name = reader.text("name", file.stem().string());
    if (board.name.empty() || board.name.find_first_of(" \t/") != std::string::npos)
        reader.fault("name", "a board's name has no spaces and no \"/\" in it");
    board.board = reader.text("board", "uno");
    std::vector<std::string> boards;
    for (const auto& kind : BoardKind::all())
        boards.push_back(kind.name);
    const auto* kind = BoardKind::find(board.board);
    if (kind == nullptr) {
        reader.fault("board", fmt::format("there is no board \"{}\"{}; one of {}", board.board,
                                          text::did_you_mean(board.board, boards), fmt::join(boards, ", ")));
        return result;
    }
    if (reader.required("image") != nullptr) board.image = beside(file, reader.text("image"));
    board.eeprom = beside(file, reader.text("eeprom"));
    board.frequency = static_cast<std::uint32_t>(reader.number("frequency", 16e6, 1e6, 20e6));
    if (reader.has("uart"))
        board.uart = static_cast<char>('0' + static_cast<int>(reader.number("uart", 0, 0, 3)));
    result.link = beside(file, reader.text("link"));
    if (reader.has("tcp")) result.tcp_port = static_cast<int>(reader.number("tcp", 0, 0, 65535));
    result.reset_on_open = reader.flag("reset_on_open");
    result.world = beside(file, reader.text("world"));
    if (!result.world.empty()) {
        auto world = world::load_world(result.world);
        if (!world) reader.fault("world", world.error());
        if (world) board.world = std::move(*world);
    }
    for (auto& part : reader.list("parts"))
        board.parts.push_back(read_part(part));
    reader.refuse_others();
    if (!reader.ok()) return result;
    const auto planned = plan_parts(board, *kind);
    if (!planned) reader.fault_at(planned.error());
    return result;
}

/// "12:5: " for a byte of the text, counted from 1 as editors do.
std::string line_and_column(std::string_view text, std::size_t byte) {
    const auto before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto line_start = before.rfind('\n');
    const auto column = before.size() - (line_start == std::string_view::npos ? 0 : line_start + 1) + 1;
    return fmt::format("{}:{}", line, column);
}

}  // namespace

Expected<BoardFile> parse_board_file(std::string_view text, const std::filesystem::path& file) {
    json document;
    try {
        document = json::parse(text);
    } catch (const json::parse_error& error) {
        std::string_view what = error.what();
        const auto reason = what.rfind("; ") != std::string_view::npos ? what.substr(what.rfind("; ") + 2)
                                                                       : std::string_view("not JSON");
        return fail(fmt::format("{}:{}: not correct JSON: {}", file.string(),
                                line_and_column(text, error.byte), reason));
    }
    std::string first_fault;
    auto board = read_board(JsonReader(document, "", first_fault), file);
    if (!first_fault.empty()) return fail(file.string() + ": " + first_fault);
    return board;
}

Expected<BoardFile> load_board_file(const std::filesystem::path& file) {
    const auto text = text::file_text(file);
    if (!text) return fail(fmt::format("{}: cannot read the board file: {}", file.string(), text.error()));
    return parse_board_file(*text, file);
}

}  // namespace asip::sim
